#include "sequences/runs/run_description.h"

#include <gtest/gtest.h>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

TEST(RunDescription, FirstDifferenceOfTwoRunsIsNamed) {
  RunDescription run;
  run.scene = "atrium";
  run.frames = {0, 1, 2};
  run.extent = {64, 36};
  run.spp = 3;
  RunDescription other = run;
  EXPECT_EQ(first_difference(to_json_text(run), to_json_text(other)), "");
  other.spp = 4;
  EXPECT_EQ(first_difference(to_json_text(run), to_json_text(other)), "spp is 3 there, 4 here");
  other = run;
  other.scene = "gallery";
  EXPECT_EQ(first_difference(to_json_text(run), to_json_text(other)),
            "scene is atrium there, gallery here");
  EXPECT_EQ(first_difference(R"({"a":1})", R"({"a":1,"b":2})"), "b is not given there, 2 here");
  EXPECT_THROW((void)first_difference("[1]", "{}"), BadFile);
}

}  // namespace
}  // namespace eigenlight
