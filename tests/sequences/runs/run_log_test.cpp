#include "sequences/runs/run_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "frame/bad_file.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Every counter has a value of its own.
FrameReport report_of(int frame) {
  FrameReport report;
  report.frame = frame;
  report.cut = frame == 0;
  std::int64_t value = 1000;
  for (const FrameCounter& counter : kFrameCounters) report.*counter.value = value++;
  for (const SkipCounter& counter : kSkipCounters) report.*counter.value = value++;
  report.surface_pixels = 200;
  report.new_pixels = 50;
  report.extra_samples = 40;
  report.mean_rank = 1.5;
  report[Stage::kSource] = {10.0, 19.0};
  report[Stage::kFilter] = {3.0, 5.0};
  return report;
}

TEST(RunLog, WritesOneLinePerFrame) {
  const TempDir dir;
  {
    RunLog log(dir.path(), {5, 6}, 0);
    log.append(report_of(5), 3, {{1.5, 2.5}, {7.0, 8.0}, {900, 1, 12}, {4.0, 6.0}});
    log.append(report_of(6), 3, {});
  }
  const std::string text = read_whole_file(dir / "frames.jsonl");
  const json line = json::parse(text.substr(0, text.find('\n')));
  EXPECT_EQ(line["frame"], 5);
  EXPECT_EQ(line["cut"], false);
  EXPECT_EQ(line["samples"], 3 * 200 + 40);
  EXPECT_EQ(line["new_share"], 0.25);
  EXPECT_EQ(line["rank"], 1.5);
  EXPECT_EQ(line["stages"]["source"]["cpu_ms"], 19.0);
  EXPECT_EQ(line["stages"]["write"]["wall_ms"], 1.5);
  EXPECT_EQ(line["stages"]["antialias"]["cpu_ms"], 8.0);
  EXPECT_EQ(line["stages"]["direct"]["cpu_ms"], 6.0);
  EXPECT_EQ(line["antialias"]["rays"], 900);
  EXPECT_EQ(line["antialias"]["non_finite"], 1);
  EXPECT_EQ(line["antialias"]["unmatched"], 12);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

TEST(RunLog, EveryCounterIsInItsLine) {
  const TempDir dir;
  const FrameReport report = report_of(0);
  RunLog(dir.path(), {0}, 0).append(report, 3, {});
  const json line = json::parse(read_whole_file(dir / "frames.jsonl"));
  for (const FrameCounter& counter : kFrameCounters) {
    EXPECT_EQ(line.at(std::string(counter.name)), report.*counter.value) << counter.name;
  }
  ASSERT_EQ(line["skipped"].size(), kSkipCounters.size());
  for (const SkipCounter& counter : kSkipCounters) {
    EXPECT_EQ(line["skipped"].at(std::string(counter.name)), report.*counter.value) << counter.name;
  }
}

TEST(RunLog, KeepsOnlyLinesOfCompleteFrames) {
  const TempDir dir;
  const std::vector<int> frames{5, 6, 7, 8};
  {
    RunLog log(dir.path(), frames, 0);
    for (const int frame : {5, 6, 7}) log.append(report_of(frame), 3, {});
  }
  const std::string before = read_whole_file(dir / "frames.jsonl");
  // A killed process may leave half a line at the end.
  write_file_atomically(dir / "frames.jsonl", before + "{\"frame\": 8, \"cu");
  {
    RunLog log(dir.path(), frames, 2);
    log.append(report_of(7), 3, {});
  }
  EXPECT_EQ(read_whole_file(dir / "frames.jsonl"), before);
  EXPECT_THAT([&] { RunLog(dir.path(), frames, 4); },
              ThrowsMessage<BadFile>(HasSubstr("line 4: expected the line of frame 8")));
  EXPECT_THAT(
      [&] {
        RunLog(dir.path(), {5, 9}, 2);
      },
      ThrowsMessage<BadFile>(HasSubstr("line 2: expected the line of frame 9")));
}

}  // namespace
}  // namespace eigenlight
