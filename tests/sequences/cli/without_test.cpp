// Parts of a method that are turned off on the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "frame/tiles.h"
#include "sequences/cli/cli.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/split_list.h"
#include "temporal/methods.h"
#include "tests/support/command_line.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Method* method_with_parts() {
  for (const Method& method : methods()) {
    if (!method.parts.empty()) return &method;
  }
  return nullptr;
}

TEST(SplitList, TakesNamesAndNumbers) {
  EXPECT_TRUE(split_list("x", "").empty());
  EXPECT_THAT(split_list("x", "a,b"), ElementsAre("a", "b"));
  EXPECT_THROW((void)split_list("x", "a,"), std::invalid_argument);
  EXPECT_THROW((void)split_list("x", "a,a"), std::invalid_argument);
  EXPECT_THAT(split_numbers("x", "3,1", {1, 3}), ElementsAre(3, 1));
  for (const char* bad : {"0", "4", "1x", "a", "1,,2"}) {
    EXPECT_THROW((void)split_numbers("x", bad, {1, 3}), std::invalid_argument) << bad;
  }
}

TEST(Without, APartThatIsNoneIsRefusedBeforeAnythingIsMade) {
  const TempDir dir;
  const Outcome run = call({"render", "cornell", "-o", dir / "a", "--without", "magic"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("method 'eigenlight' has no part 'magic' to turn off; it has: "));
  EXPECT_FALSE(std::filesystem::exists(dir / "a"));
}

TEST(Without, IsPartOfWhatARunIs) {
  const Method* method = method_with_parts();
  if (!method) GTEST_SKIP() << "no method has parts";
  const TempDir dir;
  const std::string part(method->parts.front().name);
  const std::vector<std::string> words{"render", "cornell", "-o",       dir / "a",
                                       "--size", "32x18",   "--frames", "0",
                                       "--spp",  "1",       "--method", std::string(method->name)};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), words.begin(), words.end());
    return call(more);
  };
  ASSERT_EQ(with({"--without", part}).status, 0);
  EXPECT_EQ(nlohmann::json::parse(read_whole_file(dir / "a/run.json"))["without"], part);
  const ExrReader frame(dir / "a/frame.0000.exr");
  EXPECT_EQ(std::get<std::string>(*frame.attribute("eigenlight.without")), part);
  const Outcome other = with({"--resume"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("without is " + part + " there"));
}

TEST(Without, PartsAreListed) {
  const Outcome listed = call({"methods", "--parts"});
  EXPECT_EQ(listed.status, 0);
  for (const Method& method : methods()) {
    for (const Part& part : method.parts) {
      EXPECT_THAT(listed.out, HasSubstr(std::string(part.name)));
      EXPECT_THAT(listed.out, HasSubstr(std::string(part.what)));
    }
  }
}

TEST(Without, AblationsCompareEachPart) {
  const TempDir dir;
  const Outcome run =
      call({"compare", "cornell", "-o", dir / "a", "--cache", dir / "references", "--size", "32x18",
            "--frames", "1-2", "--warmup", "1", "--spp", "1", "--reference-spp", "4", "--ablate"});
  const Method& ours = methods().front();
  ASSERT_EQ(ours.name, "eigenlight");
  if (ours.parts.empty()) {
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.err, HasSubstr("method 'eigenlight' has no parts to turn off"));
    return;
  }
  ASSERT_EQ(run.status, 0) << run.err;
  const auto results = nlohmann::json::parse(read_whole_file(dir / "a/results.json"));
  EXPECT_EQ(results["scenes"][0]["cells"].size(), 1 + ours.parts.size());
  EXPECT_EQ(results["settings"]["contenders"][1]["without"], std::string(ours.parts.front().name));
  EXPECT_THAT(read_whole_file(dir / "a/index.html"), HasSubstr("What each part is worth"));
}

}  // namespace
}  // namespace eigenlight
