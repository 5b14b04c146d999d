// The page of a run and its log.
#include "sequences/denoise/denoise_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sequences/denoise/denoise_record.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

DenoiseRecord record_of(int frame, double ms) {
  DenoiseRecord record;
  FrameReport report;
  report.frame = frame;
  report.surface_pixels = 10;
  report[Stage::kFilter].wall_ms = ms;
  add_report(report, record);
  return record;
}

double filter_ms(const nlohmann::json& line) {
  for (const auto& stage : line["stages"]) {
    if (stage["name"] == "filter") return stage["ms"];
  }
  return -1.0;
}

TEST(DenoiseRecord, SumsViews) {
  DenoiseRecord record = record_of(7, 3.0);
  FrameReport second = record.report;
  second.cut = true;
  add_report(second, record);
  EXPECT_EQ(record.report.frame, 7);
  EXPECT_TRUE(record.report.cut);
  EXPECT_EQ(record.report.surface_pixels, 20);
  EXPECT_EQ(record.report[Stage::kFilter].wall_ms, 6.0);
}

TEST(DenoiseLog, KeepsWholeLinesAndTheLastOfEachFrame) {
  const TempDir dir;
  const auto path = dir / "frames.jsonl";
  {
    DenoiseLog log(path, false);
    log.append(record_of(1, 1.0));
    log.append(record_of(2, 2.0));
  }
  std::ofstream(path, std::ios::app) << "{\"frame\": 3, \"sta";  // killed while it wrote
  {
    DenoiseLog log(path, true);
    log.append(record_of(2, 20.0));  // again, behind a checkpoint
    log.append(record_of(4, 4.0));
  }
  const auto lines = DenoiseLog::read(path, {1, 2, 3, 4});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0]["frame"], 1);
  EXPECT_EQ(filter_ms(lines[1]), 20.0);
  EXPECT_EQ(lines[2]["frame"], 4);
  EXPECT_EQ(DenoiseLog::read(path, {4}).size(), 1u);
  DenoiseLog fresh(path, false);
  EXPECT_TRUE(DenoiseLog::read(path, {1, 2, 3, 4}).empty());
  EXPECT_TRUE(DenoiseLog::read(dir / "none", {1}).empty());
}

class DenoisePage : public testing::Test {
 protected:
  DenoisePage() {
    for (int frame = 1; frame <= 3; ++frame) {
      FakeShot().write(dir_ / ("s.000" + std::to_string(frame) + ".exr"), frame);
    }
    settings_.files.inputs = {(dir_ / "s.####.exr").string()};
    settings_.files.output = dir_ / "out";
  }
  [[nodiscard]] Page page(const std::vector<int>& logged) const {
    const DenoisePlan plan = plan_denoising(settings_);
    std::filesystem::create_directories(denoise_page_folder(plan));
    const DenoiseTotals totals = run_denoising(settings_, plan, {[] { return false; }, [](int) {}});
    DenoiseLog log(denoise_page_folder(plan) / "frames.jsonl", false);
    for (const int frame : logged) log.append(record_of(frame, 5.0));
    return denoise_page(plan, totals);
  }

  TempDir dir_;
  DenoiseSettings settings_;
};

TEST_F(DenoisePage, ShowsAllFramesOfBothSidesAndOneKindALayer) {
  const Page made = page({1, 2, 3});
  const PageGallery& player = made.sections[0].galleries.at(0);
  EXPECT_TRUE(player.is_split);
  EXPECT_EQ(player.frames, (std::vector<int>{1, 2, 3}));
  ASSERT_EQ(player.kinds.size(), 2u);
  EXPECT_EQ(player.kinds[0].name, "View.Combined");
  EXPECT_EQ(player.kinds[1].name, "View.DiffInd");
  ASSERT_EQ(player.tiles.size(), 2u);
  for (std::size_t kind = 0; kind < 2; ++kind) {
    for (std::size_t i = 0; i < 3; ++i) {
      // Noise is what JPEG cannot shrink.
      EXPECT_GT(player.tiles[0].pictures[kind][i].size(), player.tiles[1].pictures[kind][i].size());
    }
  }
  EXPECT_EQ(player.extent, (Extent{96, 64}));
  EXPECT_EQ(made.sections.size(), 4u);
  EXPECT_EQ(made.sections[3].plots[0].frames.size(), 3u);
}

TEST_F(DenoisePage, TellsOfFramesThatTheLogHas) {
  EXPECT_EQ(page({2}).sections[3].plots[0].frames, (std::vector<int>{2}));
  EXPECT_EQ(page({}).sections.size(), 3u) << "no log: no times";
}

TEST_F(DenoisePage, AMissingOutputIsNamed) {
  const DenoisePlan plan = plan_denoising(settings_);
  (void)page({1});
  std::filesystem::remove(dir_ / "out/s.0002.exr");
  try {
    (void)denoise_page(plan, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("s.0002.exr"));
  }
}

}  // namespace
}  // namespace eigenlight
