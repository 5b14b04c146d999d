#include "frame/tiles.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/support/extents.h"

namespace eigenlight {
namespace {

class ThreadCount : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST(TileGrid, CoversEachPixelOnce) {
  for (const Extent extent : kSweepExtents) {
    for (const TileGrid& grid : {stage_tiles(extent), TileGrid(extent, 32, 32),
                                 TileGrid(extent, 1, 1), TileGrid(extent, 1000, 7)}) {
      Plane<int> visits(extent);
      for (int i = 0; i < grid.count(); ++i) {
        const Tile tile = grid.tile(i);
        EXPECT_EQ(tile.index, i);
        EXPECT_EQ(tile.x0 % grid.tile_width(), 0);
        EXPECT_EQ(tile.y0 % grid.tile_height(), 0);
        EXPECT_EQ(tile.pixels(), (tile.x1 - tile.x0) * (tile.y1 - tile.y0));
        for (int y = tile.y0; y < tile.y1; ++y) {
          for (int x = tile.x0; x < tile.x1; ++x) ++visits(x, y);
        }
      }
      EXPECT_EQ(grid.count(), grid.columns() * grid.rows());
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) ASSERT_EQ(visits(x, y), 1) << x << ", " << y;
      }
    }
  }
}

TEST(TileGrid, RejectsEmptyImagesAndTiles) {
  EXPECT_THROW(TileGrid({0, 4}, 8, 8), std::invalid_argument);
  EXPECT_THROW(TileGrid({4, 4}, 0, 8), std::invalid_argument);
  EXPECT_THROW(TileGrid({4, 4}, 8, -1), std::invalid_argument);
}

TEST_P(ThreadCount, ParallelForCallsEachIndexOnce) {
  for (const int count : {0, 1, 2, 1000}) {
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));
    parallel_for(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
    for (const auto& c : calls) EXPECT_EQ(c.load(), 1);
  }
}

TEST_P(ThreadCount, ForEachTileVisitsTheGrid) {
  const TileGrid grid({65, 17}, 8, 4);
  std::vector<int> pixels(static_cast<std::size_t>(grid.count()));
  for_each_tile(grid, [&](const Tile& tile) {
    pixels[static_cast<std::size_t>(tile.index)] += tile.pixels();
  });
  EXPECT_EQ(std::accumulate(pixels.begin(), pixels.end(), 0), 65 * 17);
}

TEST_P(ThreadCount, ExceptionsReachTheCaller) {
  const auto fail = [](int i) {
    if (i == 37) throw std::out_of_range("thirty-seven");
  };
  try {
    parallel_for(100, fail);
    FAIL() << "the exception was lost";
  } catch (const std::out_of_range& error) {
    EXPECT_STREQ(error.what(), "thirty-seven");
  }
  std::atomic<int> calls = 0;
  parallel_for(100, [&](int) { ++calls; });
  EXPECT_EQ(calls.load(), 100);
}

TEST_P(ThreadCount, LoopsCanBeNested) {
  std::atomic<int> calls = 0;
  parallel_for(8, [&](int) { parallel_for(8, [&](int) { ++calls; }); });
  EXPECT_EQ(calls.load(), 64);
}

INSTANTIATE_TEST_SUITE_P(Threads, ThreadCount, ::testing::Values(1, 2, 3),
                         ::testing::PrintToStringParamName());

TEST(SetThreadCount, ZeroMeansOneThreadPerCore) {
  set_thread_count(3);
  EXPECT_EQ(thread_count(), 3);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
  EXPECT_THROW(set_thread_count(-1), std::invalid_argument);
  EXPECT_THROW(set_thread_count(1025), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
