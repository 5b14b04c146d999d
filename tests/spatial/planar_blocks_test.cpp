#include "spatial/planar_blocks.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/kernel_test.h"
#include "tests/support/targets.h"
#include "tests/support/walls.h"

namespace eigenlight {
namespace {

constexpr float kTolerance = 2e-5f;
constexpr Extent kSmall{64, 48};  // 8 x 6 blocks, 1 x 3 tiles of 64 x 16
constexpr int kNoEdge = 1 << 20;

// One digit for each block of a row of blocks.
std::string margins(const PlanarBlocks& blocks, int row, int columns = 8) {
  std::string digits;
  for (int i = 0; i < columns; ++i) digits += static_cast<char>('0' + blocks.margins(row)[i]);
  return digits;
}

PlanarBlocks find(const Frame& frame) {
  PlanarBlocks blocks(frame.extent(), kTolerance);
  blocks.find(frame, PerTile<std::uint8_t>(stage_tiles(frame.extent()), 1));
  return blocks;
}

EL_KERNEL_TEST(PlanarBlocks, WallIsPlanarEverywhere) {
  const Frame frame = make_walls(extent, kNoEdge);
  on_every_target([&] {
    const PlanarBlocks blocks = find(frame);
    EXPECT_EQ(blocks.pixels(), static_cast<std::int64_t>(extent.pixels()));
    EXPECT_EQ(blocks.margins((extent.height - 1) / 8)[(extent.width - 1) / 8], 2);
  });
}

TEST(PlanarBlocks, EdgeEndsThePlaneOnBothSides) {
  EXPECT_EQ(margins(find(make_walls(kSmall, 32)), 2), "22100122");
  EXPECT_EQ(margins(find(make_walls(kSmall, 33)), 2), "22100012");  // the fifth block is mixed
}

// One pixel in the middle of the image keeps its block from being planar.
class PlanarBlocksPixel : public ::testing::Test {
 protected:
  void expect_hole() {
    for_each_target([&] {
      const PlanarBlocks blocks = find(frame_);
      EXPECT_EQ(margins(blocks, 2), "21000122");
      EXPECT_EQ(margins(blocks, 5), "22222222");
      EXPECT_EQ(margins(blocks, 4), "21111122");
      EXPECT_EQ(blocks.pixels(), 64 * 48 - 9 * 64);
    });
  }
  static constexpr int kX = 30, kY = 18;
  Frame frame_ = make_walls(kSmall, kNoEdge);
};

TEST_F(PlanarBlocksPixel, SkyIsNotPlanar) {
  open_to_sky(frame_, kX, kY);
  expect_hole();
}

TEST_F(PlanarBlocksPixel, MissingIdIsNotPlanar) {
  frame_.surface.id(kX, kY) = 0;
  expect_hole();
}

TEST_F(PlanarBlocksPixel, OtherDepthIsNotPlanar) {
  frame_.surface.depth(kX, kY) *= 1.0001f;
  expect_hole();
}

TEST_F(PlanarBlocksPixel, OtherNormalIsNotPlanar) {
  frame_.surface.normal[1](kX, kY) += 0.002f;
  frame_.surface.normal[2](kX, kY) -= 0.002f;
  expect_hole();
}

TEST_F(PlanarBlocksPixel, NormalOfOtherLengthIsNotPlanar) {
  for (auto& plane : frame_.surface.normal) plane(kX, kY) *= 1.0001f;
  expect_hole();
}

TEST_F(PlanarBlocksPixel, NanNormalIsNotPlanar) {
  frame_.surface.normal[0](24, 16) = std::numeric_limits<float>::quiet_NaN();
  expect_hole();
}

TEST(PlanarBlocks, DepthsWithinTheToleranceAreOnePlane) {
  Frame frame = make_walls(kSmall, kNoEdge);
  frame.surface.depth(30, 18) *= 1.00001f;
  EXPECT_EQ(find(frame).pixels(), 64 * 48);
}

// Two parallel planes, each filling a block, are not one plane.
TEST(PlanarBlocks, NeighborsMustLieInTheSamePlane) {
  Frame frame = make_walls(kSmall, kNoEdge);
  for (int y = 16; y < 24; ++y) {
    for (int x = 24; x < 32; ++x) frame.surface.depth(x, y) *= 1.01f;
  }
  EXPECT_EQ(margins(find(frame), 2), "21000122");
}

TEST(PlanarBlocks, UnselectedTilesAreNotPlanar) {
  const Frame frame = make_walls(kSmall, kNoEdge);
  PlanarBlocks blocks(kSmall, kTolerance);
  PerTile<std::uint8_t> chosen(stage_tiles(kSmall), 1);
  chosen[2] = 0;
  blocks.find(frame, chosen);
  for (const auto& [row, expected] : {std::pair{0, '2'}, {1, '2'}, {2, '1'}, {3, '0'}, {4, '0'}}) {
    EXPECT_EQ(margins(blocks, row), std::string(8, expected)) << row;
  }
  blocks.clear();
  EXPECT_EQ(blocks.pixels(), 0);
}

TEST(PlanarBlocks, RejectsOtherExtentsAndTolerances) {
  const Frame frame = make_walls(kSmall, kNoEdge);
  PlanarBlocks other({65, 48}, kTolerance), same(kSmall, kTolerance);
  EXPECT_THROW(other.find(frame, PerTile<std::uint8_t>(stage_tiles({65, 48}), 1)),
               std::invalid_argument);
  EXPECT_THROW(same.find(frame, PerTile<std::uint8_t>(stage_tiles({64, 32}), 1)),
               std::invalid_argument);
  EXPECT_THROW(PlanarBlocks(kSmall, 0.0f), std::invalid_argument);
  EXPECT_THROW(PlanarBlocks(kSmall, 1.5f), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
