// `eigenlight compare --paper` in this process.
#include "sequences/cli/compare_paper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/command_line.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

TEST(ComparePaper, UnfitOptionsAreNamed) {
  const TempDir dir;
  const std::filesystem::path out = dir / "out";
  const auto expect_error = [&](std::vector<std::string> words, const std::string& message) {
    words.insert(words.begin(), "compare");
    words.insert(words.end(), {"-o", out.string()});
    const Outcome outcome = call(words);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  };
  const auto paper = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"--paper", "chen2012"});
    return words;
  };
  expect_error({}, "scenes or --paper is required");
  expect_error({"--paper", "chen2013"}, "unknown paper 'chen2013'; known: chen2012, ");
  expect_error(paper({"--frames", "0-3"}), "frames '0-3': expected 8 or more frames, ascending");
  expect_error(paper({"--frames", "9-0"}), "frames '9-0': expected 8 or more frames, ascending");
  expect_error(paper({"--size", "8"}), "size '8': expected WIDTHxHEIGHT");
  expect_error(paper({"--spp", "4"}), "--spp excludes --paper");
  expect_error(paper({"cornell"}), "scenes excludes --paper");
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace eigenlight
