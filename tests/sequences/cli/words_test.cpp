// What the program says of wrong words, and of folders that are not empty.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/command_line.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

class Words : public testing::Test {
 protected:
  Outcome render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", "cornell", "-o", dir_ / "a", "--size", "32x18", "--spp",
                               "1", "--method", "noisy"});
    return call(more);
  }

  TempDir dir_;
};

TEST_F(Words, WhatIsNotExpectedIsNamedInTheOrderTyped) {
  const Outcome extra = render({"--unknown", "3", "--more"});
  EXPECT_EQ(extra.status, 2);
  EXPECT_THAT(extra.err,
              HasSubstr("not expected: --unknown 3 --more; see eigenlight render --help"));
  const Outcome early = call({"-o", "out", "render", "cornell"});
  EXPECT_EQ(early.status, 2);
  EXPECT_THAT(early.err, HasSubstr("not expected before 'render': -o out; options follow the "
                                   "command; see eigenlight render --help"));
}

TEST_F(Words, BuiltInScenesHaveNoEnvironmentMap) {
  const Outcome outcome = render({"--environment"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--environment: the built-in scene 'cornell' has no"));
}

TEST_F(Words, FramesOfAnotherRunAreTold) {
  EXPECT_EQ(render({"--frames", "0-2"}).status, 0);
  const Outcome again = render({"--frames", "1", "--seed", "2"});
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err,
              HasSubstr("note: " + (dir_ / "a").string() +
                        ": holds 2 frames of another run beside those of this one: 0,2"));
}

TEST_F(Words, CompareLooksAtAllScenesBeforeItMeasuresOne) {
  const Outcome outcome =
      call({"compare", "cornell", "nowhere", "-o", dir_ / "c", "--size", "32x18"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("unknown scene 'nowhere'"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "c"));
}

}  // namespace
}  // namespace eigenlight
