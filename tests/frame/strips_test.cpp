#include "frame/strips.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "tests/support/extents.h"

namespace eigenlight {
namespace {

TEST(Strips, CoverEachPixelOnce) {
  for (const Extent extent : kSweepExtents) {
    for (const TileGrid& grid :
         {stage_tiles(extent), TileGrid(extent, 32, 32), TileGrid(extent, 1000, 7)}) {
      Plane<int> visits(extent);
      std::vector<int> next(static_cast<std::size_t>(grid.count()), -1);
      for_each_segment(grid, [&](const Tile& row) {
        const Tile tile = grid.tile(row.index);
        EXPECT_EQ(row.x0, tile.x0);
        EXPECT_EQ(row.x1, tile.x1);
        EXPECT_EQ(row.y1, row.y0 + 1);
        int& y = next[static_cast<std::size_t>(row.index)];
        EXPECT_EQ(row.y0, y < 0 ? tile.y0 : y);
        y = row.y1;
        for (int x = row.x0; x < row.x1; ++x) ++visits(x, row.y0);
      });
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) ASSERT_EQ(visits(x, y), 1) << x << ", " << y;
      }
    }
  }
}

TEST(Strips, StayWithinTheWidthLimit) {
  const TileGrid grid({3000, 70}, 32, 32);
  for_each_strip(grid, [&](const Strip& strip) {
    EXPECT_EQ(strip.area.x0, grid.tile(strip.area.index).x0);
    EXPECT_EQ(strip.area.x1, grid.tile(strip.area.index + strip.tiles - 1).x1);
    EXPECT_LE(strip.area.x1 - strip.area.x0, kStripWidth);
    EXPECT_EQ(strip.area.y1, grid.tile(strip.area.index).y1);
  });
}

TEST(Strips, NarrowWithTheNumberOfThreads) {
  const TileGrid grid({1280, 720}, 32, 32);
  const auto count_strips = [&](int threads) {
    set_thread_count(threads);
    std::atomic<int> strips = 0;
    for_each_strip(grid, [&](const Strip&) { ++strips; });
    set_thread_count(0);
    return strips.load();
  };
  EXPECT_EQ(count_strips(1), 23);
  EXPECT_EQ(count_strips(2), 23);
  EXPECT_EQ(count_strips(4), 2 * 23);
  EXPECT_EQ(count_strips(64), 5 * 23);
}

TEST(Strips, BandsCoverTheirStripInOrder) {
  const TileGrid grid({300, 70}, 32, 32);
  std::atomic<int> pixels = 0;
  for_each_strip(grid, [&](const Strip& strip) {
    int y = strip.area.y0;
    for_each_band(strip, 5, [&](const Strip& band) {
      EXPECT_EQ(band.area.y0, y);
      EXPECT_LE(band.area.y1 - band.area.y0, 5);
      y = band.area.y1;
      int x = band.area.x0;
      for_each_part(grid, band, [&](const Tile& part) {
        EXPECT_EQ(part.x0, x);
        EXPECT_EQ(part.y0, band.area.y0);
        EXPECT_EQ(part.x1, grid.tile(part.index).x1);
        x = part.x1;
        pixels += part.pixels();
      });
      EXPECT_EQ(x, band.area.x1);
    });
    EXPECT_EQ(y, strip.area.y1);
  });
  EXPECT_EQ(pixels, 300 * 70);
}

}  // namespace
}  // namespace eigenlight
