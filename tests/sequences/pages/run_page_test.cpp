#include "sequences/pages/run_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sequences/files/atomic_file.h"
#include "sequences/pages/run_pictures.h"
#include "tests/support/fake_run.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

std::vector<int> first_frames(int count) {
  std::vector<int> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), 10);
  return frames;
}

const PageSection& player_section(const Page& page) { return page.sections.at(0); }
const PageTable& skip_table(const Page& page) { return page.sections.at(1).tables.at(2); }
const PageSection& plot_section(const Page& page) { return page.sections.at(2); }

std::vector<std::string> row_names(const PageTable& table) {
  std::vector<std::string> names;
  for (const TableRow& row : table.rows) names.push_back(row.name);
  return names;
}

TEST(RunPage, ShowsPicturesOfAllKindsAndSides) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(3)});
  const Page page = run_page(dir.path());
  EXPECT_EQ(page.title, "A made-up room: running-mean");
  ASSERT_EQ(player_section(page).galleries.size(), 1u);
  const PageGallery& player = player_section(page).galleries[0];
  EXPECT_TRUE(player.is_split);
  EXPECT_THAT(player.frames, ElementsAre(10, 11, 12));
  EXPECT_EQ(player.kinds.size(), 2u);
  ASSERT_EQ(player.tiles.size(), 2u);
  EXPECT_EQ(player.tiles[0].name, "noisy");
  EXPECT_EQ(player.tiles[1].name, "denoised (running-mean)");
  for (const GalleryTile& tile : player.tiles) {
    EXPECT_THAT(tile.pictures,
                Each(AllOf(SizeIs(3), Each(StartsWith("data:image/jpeg;base64,/9j/")))));
  }
}

// It is the sum of what was sampled, however the picture beside it was antialiased.
TEST(RunPage, TheNoisyPictureHoldsAllNoisyLight) {
  const TempDir dir;
  const auto noisy_picture = [&](const FakeRun& run) {
    write_fake_run(dir.path(), run);
    return run_pictures(dir.path(), {0}, {}).tiles.at(0).pictures.at(0).at(0);
  };
  EXPECT_EQ(noisy_picture({.has_picture = true}), noisy_picture({}));
}

TEST(RunPage, ShowsTheTimesOfAllStages) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(3)});
  const Page page = run_page(dir.path());
  std::vector<std::string> stages(kStageNames.begin(), kStageNames.end());
  EXPECT_THAT(page.names, IsSupersetOf(stages));
  EXPECT_THAT(page.background.names, ElementsAre("source", "resample", "write"))
      << "antialiasing took no time";
  EXPECT_THAT(row_names(page.sections[1].tables[1]), IsSupersetOf(stages));
  const PagePlot& plot = plot_section(page).plots.at(0);
  EXPECT_TRUE(plot.is_stacked);
  EXPECT_EQ(plot.series.size(), page.names.size());
  EXPECT_THAT(plot.series, Each(testing::Field(&PlotSeries::points, SizeIs(3))));
}

TEST(RunPage, ShowsEverySkipCounterOfTheLog) {
  const TempDir dir;
  const FakeRun run{.frames = {4}};
  write_fake_run(dir.path(), run);
  const auto log = nlohmann::json::parse(read_whole_file(dir / "frames.jsonl"));
  const Page page = run_page(dir.path());
  ASSERT_EQ(skip_table(page).rows.size(), log["skipped"].size());
  // Every counter has a text of its own in place of its name.
  for (const TableRow& row : skip_table(page).rows) EXPECT_FALSE(log["skipped"].contains(row.name));
  const auto share = [&](std::size_t row) {
    return std::get<double>(skip_table(page).rows[row].cells[1]);
  };
  EXPECT_NEAR(share(1), 20.0, 0.1);  // surface
  EXPECT_NEAR(share(5), 50.0, 0.1);  // correction
}

TEST(RunPage, DrawsNewPixelsAndRankOnlyWhereThereIsASurface) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(2)});
  auto line =
      nlohmann::json::parse(read_whole_file(dir / "frames.jsonl")
                                .substr(0, read_whole_file(dir / "frames.jsonl").find('\n')));
  line["frame"] = 12;
  line["surface_pixels"] = 0;
  std::ofstream(dir / "frames.jsonl", std::ios::app) << line.dump() << '\n';
  const Page page = run_page(dir.path());
  for (const std::size_t i : {1u, 2u}) {
    const auto& points = plot_section(page).plots.at(i).series.at(0).points;
    ASSERT_EQ(points.size(), 3u);
    EXPECT_TRUE(std::isfinite(points[0].y));
    EXPECT_TRUE(std::isnan(points[2].y));
  }
  EXPECT_EQ(plot_section(page).plots[1].series[0].points[0].y, 100.0);
  EXPECT_THAT(plot_section(page).plots[1].off_scale, ElementsAre(10, 12)) << "these are cuts";
}

TEST(RunPage, LeavesOutMissingLayers) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = {1}, .layers = "color"});
  const PageGallery gallery = run_pictures(dir.path(), {1}, {});
  EXPECT_EQ(gallery.kinds.size(), 1u);
  EXPECT_EQ(gallery.tiles.size(), 1u);
  const TempDir other;
  write_fake_run(other.path(), {.frames = {1}, .layers = "albedo"});
  EXPECT_TRUE(run_pictures(other.path(), {1}, {}).frames.empty());
  const Page page = run_page(other.path());
  EXPECT_TRUE(player_section(page).galleries.empty());
  EXPECT_THAT(player_section(page).note, HasSubstr("No pictures"));
}

TEST(RunPage, ThinsLongRunsAndShrinksLargePictures) {
  const TempDir dir;
  const FakeRun run{.frames = first_frames(10)};
  write_fake_run(dir.path(), run);
  const PageGallery thinned = run_pictures(dir.path(), run.frames, {.max_frames = 4});
  EXPECT_THAT(thinned.frames, ElementsAre(10, 13, 16, 19));
  EXPECT_NEAR(thinned.frames_per_second, 9.6, 1e-5);
  const PageGallery shrunk = run_pictures(dir.path(), run.frames, {.max_bytes = 30000});
  EXPECT_EQ(shrunk.frames.size(), 10u);
  EXPECT_LT(shrunk.extent.width, run.extent.width);
  std::size_t bytes = 0;
  for (const GalleryTile& tile : shrunk.tiles) {
    for (const auto& of_kind : tile.pictures) {
      for (const std::string& uri : of_kind) bytes += uri.size();
    }
  }
  EXPECT_LT(bytes, 30000u * 4 / 3 * 11 / 10);
  EXPECT_EQ(run_pictures(dir.path(), run.frames, {}).extent, run.extent);
}

TEST(RunPage, KeepsFramesWithoutAFileInThePlots) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(3)});
  std::filesystem::remove(dir / "frame.0011.exr");
  const Page page = run_page(dir.path());
  EXPECT_THAT(plot_section(page).plots[0].frames, ElementsAre(10, 11, 12));
  EXPECT_THAT(player_section(page).galleries[0].frames, ElementsAre(10, 12));
}

TEST(RunPage, NamesTheFileAndLineThatItCannotRead) {
  const TempDir dir;
  const auto write = [&] { write_run_page(dir.path()); };
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("run.json")));
  write_fake_run(dir.path(), {.frames = first_frames(2)});
  std::ofstream(dir / "frames.jsonl", std::ios::app) << "{\"frame\": 3}\n";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(
                         AllOf(HasSubstr("frames.jsonl: line 3: field '"), HasSubstr("missing"))));
  std::ofstream(dir / "frames.jsonl") << "oh\n";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("line 1: expected a JSON")));
  std::ofstream(dir / "frames.jsonl") << "";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("no frame is done yet")));
  EXPECT_FALSE(std::filesystem::exists(dir / "index.html"));
}

TEST(RunPage, NamesThePictureThatItCannotRead) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(2)});
  std::ofstream(dir / "frame.0011.exr") << "not a picture";
  EXPECT_THAT([&] { write_run_page(dir.path()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("frame.0011.exr")));
}

TEST(RunPage, ShowsTheTitleAsTextAndNeverAsMarkup) {
  const TempDir dir;
  write_fake_run(dir.path(), {.title = "</script><script>\"bad\" & {{data}}", .frames = {1}});
  write_run_page(dir.path());
  const std::string page = read_whole_file(dir / "index.html");
  EXPECT_THAT(page, Not(HasSubstr("</script><script>\"bad\"")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;&quot;bad&quot; &amp; {{data}}"));
}

}  // namespace
}  // namespace eigenlight
