// `eigenlight train-pyramid` and `eigenlight judge-pyramid` in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/command_line.h"
#include "tests/support/painted_picture.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

// Status and error of a command whose words follow `words`.
Outcome call_with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return call(words);
}

void expect_usage_error(const Outcome& outcome, const std::string& message) {
  EXPECT_EQ(outcome.status, 2) << message;
  EXPECT_THAT(outcome.err, HasSubstr(message));
}

TEST(TrainPyramidCommand, NamesAFileThatIsMissingOrTooSmall) {
  const TempDir dir;
  const std::string table = dir / "table.cpp";
  const std::vector<std::string> words{"train-pyramid", "-o", table, "--painted", "0", "--images"};
  const Outcome missing = call_with(words, {"no/such.png"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.err, HasSubstr("no/such.png"));
  write_painted_picture(dir / "small.exr", {40, 36});
  const Outcome small = call_with(words, {dir / "small.exr"});
  EXPECT_EQ(small.status, 2);
  EXPECT_THAT(small.err, HasSubstr("small.exr: 40x36 pixels, expected 128"));
  EXPECT_FALSE(std::filesystem::exists(table));
}

TEST(TrainPyramidCommand, MissingDirectoryIsReportedBeforeTraining) {
  const TempDir dir;
  const Outcome outcome = call({"train-pyramid", "-o", dir / "no/table.cpp"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("no/table.cpp: cannot write: "));
}

TEST(TrainPyramidCommand, BadOptionsAreNamed) {
  expect_usage_error(call({"train-pyramid", "--painted", "1"}), "--output is required");
  const std::vector<std::string> words{"train-pyramid", "-o", "x"};
  expect_usage_error(call_with(words, {"--painted", "65"}), "painted 65: expected 0 to 64");
  expect_usage_error(call_with(words, {"--steps", "-1"}), "steps -1");
  expect_usage_error(call_with(words, {"--painted", "0", "--scenes", "nowhere"}),
                     "unknown scene 'nowhere'; known: cornell, ");
}

TEST(JudgePyramidCommand, BadOptionsAreNamed) {
  const std::vector<std::string> words{"judge-pyramid", "--painted", "1", "--side", "16"};
  expect_usage_error(call_with(words, {"--radii", "0"}), "radius 0: expected 1 to 64");
  expect_usage_error(call_with(words, {"--radii", "65"}), "radius 65: expected 1 to 64");
  expect_usage_error(call_with(words, {"--scenes", "nowhere"}),
                     "unknown scene 'nowhere'; known: cornell, ");
  expect_usage_error(call_with(words, {"--side", "4"}), "side 4: expected 8 to 1024");
}

}  // namespace
}  // namespace eigenlight
