#include "sequences/runs/run_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sequences/files/atomic_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::ThrowsMessage;

FrameReport report_of(int frame) {
  FrameReport report;
  report.frame = frame;
  report.cut = frame == 0;
  report.rays = 1000;
  report.surface_pixels = 200;
  report.new_pixels = 50;
  report.extra_samples = 40;
  report.mean_rank = 1.5;
  report.skipped_filter = 17;
  report.skipped_geometry = 19;
  report.non_finite_pixels = 2;
  report[Stage::kSource] = {10.0, 19.0};
  report[Stage::kFilter] = {3.0, 5.0};
  return report;
}

TEST(RunLog, WritesALineForEachFrame) {
  const TempDir dir;
  {
    RunLog log(dir.path(), {5, 6}, 0);
    log.append(report_of(5), 3, {{1.5, 2.5}, {7.0, 8.0}, {900, 1, 12}});
    log.append(report_of(6), 3, {});
  }
  const std::string text = read_whole_file(dir / "frames.jsonl");
  const json line = json::parse(text.substr(0, text.find('\n')));
  EXPECT_EQ(line["frame"], 5);
  EXPECT_EQ(line["cut"], false);
  EXPECT_EQ(line["rays"], 1000);
  EXPECT_EQ(line["samples"], 3 * 200 + 40);
  EXPECT_EQ(line["new_share"], 0.25);
  EXPECT_EQ(line["rank"], 1.5);
  EXPECT_EQ(line["skipped"]["filter"], 17);
  EXPECT_EQ(line["skipped"]["geometry"], 19);
  EXPECT_EQ(line["non_finite_pixels"], 2);
  EXPECT_EQ(line["stages"]["source"]["cpu_ms"], 19.0);
  EXPECT_EQ(line["stages"]["write"]["wall_ms"], 1.5);
  EXPECT_EQ(line["stages"]["antialias"]["cpu_ms"], 8.0);
  EXPECT_EQ(line["antialias"]["rays"], 900);
  EXPECT_EQ(line["antialias"]["non_finite"], 1);
  EXPECT_EQ(line["antialias"]["unmatched"], 12);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

TEST(RunLog, KeepsTheLinesOfCompleteFramesOnly) {
  const TempDir dir;
  const std::vector<int> frames{5, 6, 7, 8};
  {
    RunLog log(dir.path(), frames, 0);
    for (const int frame : {5, 6, 7}) log.append(report_of(frame), 3, {});
  }
  const std::string before = read_whole_file(dir / "frames.jsonl");
  // As a killed process may leave it: half a line at the end.
  write_file_atomically(dir / "frames.jsonl", before + "{\"frame\": 8, \"cu");
  {
    RunLog log(dir.path(), frames, 2);
    log.append(report_of(7), 3, {});
  }
  EXPECT_EQ(read_whole_file(dir / "frames.jsonl"), before);
  EXPECT_THAT([&] { RunLog(dir.path(), frames, 4); },
              ThrowsMessage<std::runtime_error>(HasSubstr("line 4: expected the line of frame 8")));
  EXPECT_THAT(
      [&] {
        RunLog(dir.path(), {5, 9}, 2);
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("line 2: expected the line of frame 9")));
}

TEST(RunLog, NamesTheFirstDifferenceOfTwoRuns) {
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
  EXPECT_THROW((void)first_difference("[1]", "{}"), std::runtime_error);
}

TEST(RunLog, TotalsAreMeansAndRates) {
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
  totals.add(report_of(2), {{3.0, 4.0}, {9.0, 18.0}, {900, 1, 12}});
  EXPECT_THAT(totals.to_text("out"), HasSubstr("antialias 3.0, write 3.0 ms a frame"));
  EXPECT_THAT(totals.to_text("out"), HasSubstr("excluded: 7 pixels or samples"));
  EXPECT_EQ(json::parse(totals.to_json("out"))["mean_ms"]["antialias"]["cpu"], 6.0);
}

}  // namespace
}  // namespace eigenlight
