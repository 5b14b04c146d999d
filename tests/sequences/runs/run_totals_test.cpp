#include "sequences/runs/run_totals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace eigenlight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

FrameReport report_of(int frame) {
  FrameReport report;
  report.frame = frame;
  report.rays = 1000;
  report.non_finite_pixels = 2;
  report[Stage::kSource] = {10.0, 19.0};
  report[Stage::kFilter] = {3.0, 5.0};
  return report;
}

TEST(RunTotals, SummariesHoldMeansAndRates) {
  RunTotals totals;
  totals.add(report_of(0), {{2.0, 4.0}});
  totals.add(report_of(1), {{4.0, 4.0}});
  EXPECT_THAT(totals.to_text("out"), testing::Not(HasSubstr("antialias")));
  totals.seconds = 1.25;
  EXPECT_NEAR(totals.mega_rays_per_second(), 2000 / 20e-3 * 1e-6, 1e-9);
  const json summary = json::parse(totals.to_json("out"));
  EXPECT_EQ(summary["frames"], 2);
  EXPECT_EQ(summary["seconds"], 1.25);
  EXPECT_EQ(summary["mean_ms"]["write"]["wall"], 3.0);
  EXPECT_EQ(summary["mean_ms"]["filter"]["cpu"], 5.0);
  EXPECT_EQ(summary["directory"], "out");
  EXPECT_THAT(totals.to_text("out"), HasSubstr("render 10.0, denoise 3.0, write 3.0 ms a frame"));
  EXPECT_THAT(totals.to_text("out"), HasSubstr("excluded: 4 pixels or samples"));
  totals.add(report_of(2), {{3.0, 4.0}, {9.0, 18.0}, {900, 1, 12}, {6.0, 9.0}});
  EXPECT_THAT(totals.to_text("out"), HasSubstr("denoise 5.0, antialias 3.0, write 3.0 ms a frame"));
  EXPECT_THAT(totals.to_text("out"), HasSubstr("excluded: 7 pixels or samples"));
  EXPECT_EQ(json::parse(totals.to_json("out"))["mean_ms"]["antialias"]["cpu"], 6.0);
  EXPECT_EQ(json::parse(totals.to_json("out"))["mean_ms"]["direct"]["cpu"], 3.0);
}

}  // namespace
}  // namespace eigenlight
