// --without turns off parts of a method.
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
#include "temporal/methods.h"
#include "tests/support/command_line.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

TEST(Without, UnknownPartIsAnErrorAndMakesNothing) {
  const TempDir dir;
  const Outcome run = call({"render", "cornell", "-o", dir / "a", "--without", "magic"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("method 'eigenlight' has no part 'magic' to turn off; it has: "));
  EXPECT_FALSE(std::filesystem::exists(dir / "a"));
}

TEST(Without, IsRecordedInRunAndFilesAndCheckedOnResume) {
  const TempDir dir;
  const std::string part = "atrous";
  const std::vector<std::string> words{"render", "cornell",  "-o", dir / "a", "--size",
                                       "32x18",  "--frames", "0",  "--spp",   "1"};
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

TEST(Without, MethodsCommandListsAllParts) {
  const Outcome listed = call({"methods", "--parts"});
  EXPECT_EQ(listed.status, 0);
  for (const Method& method : methods()) {
    for (const Part& part : method.parts) {
      EXPECT_THAT(listed.out, HasSubstr(std::string(part.name)));
      EXPECT_THAT(listed.out, HasSubstr(std::string(part.what)));
    }
  }
}

TEST(Without, AblateComparesTheMethodWithoutEachPart) {
  const TempDir dir;
  const Outcome run =
      call({"compare", "cornell", "-o", dir / "a", "--cache", dir / "references", "--size", "32x18",
            "--frames", "1-2", "--warmup", "1", "--spp", "1", "--reference-spp", "4", "--ablate"});
  const Method& ours = methods().front();
  ASSERT_EQ(ours.name, "eigenlight");
  ASSERT_FALSE(ours.parts.empty());
  ASSERT_EQ(run.status, 0) << run.err;
  const auto results = nlohmann::json::parse(read_whole_file(dir / "a/results.json"));
  EXPECT_EQ(results["scenes"][0]["cells"].size(), 1 + ours.parts.size());
  EXPECT_EQ(results["settings"]["contenders"][1]["without"], std::string(ours.parts.front().name));
  EXPECT_THAT(read_whole_file(dir / "a/index.html"), HasSubstr("What each part is worth"));
}

}  // namespace
}  // namespace eigenlight
