#include "temporal/residual_cells.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/reference/residual_cells.h"
#include "tests/support/compare.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

// Tilted planes, some pixels unconfirmed with light that is not a number.
struct Scene {
  explicit Scene(Extent extent)
      : guides(make_random_frame({.extent = extent, .disturbed = false, .non_finite = false}, 2)),
        light(make_planes<3>(extent)),
        prediction(make_planes<3>(extent)),
        correction(make_planes<3>(extent)),
        confirmed(extent),
        age(random_plane(extent, 3, 1.0f, 40.0f)),
        samples(random_plane(extent, 4, 1.0f, 3.0f)),
        variance(random_plane(extent, 5, 0.1f, 2.0f)),
        residual(random_plane(extent, 6, -1.0f, 1.0f)),
        cells(extent) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        PixelRandom random(9, x, y);
        const bool used = guides.surface.id(x, y) != 0 && random.uniform() < 0.8f;
        confirmed(x, y) = used ? 1.0f : 0.0f;
        if (!used) samples(x, y) = 0.0f;
        for (std::size_t c = 0; c < 3; ++c) {
          prediction[c](x, y) = random.between(0.0f, 2.0f);
          light[c](x, y) =
              used ? random.between(0.0f, 2.0f) : std::numeric_limits<float>::quiet_NaN();
        }
      }
    }
    cells.set_camera(guides.camera);
  }
  [[nodiscard]] CorrectionInputs in() const {
    return {guides, light, confirmed, age, samples, variance};
  }
  void load() {
    const TileGrid grid = stage_tiles(cells.extent());
    for (int i = 0; i < grid.count(); ++i) load_cells(in(), prediction, grid.tile(i), cells);
  }
  void spread() {
    const TileGrid grid(guides.extent(), 32, 32);
    for (int i = 0; i < grid.count(); ++i) {
      spread_cells(cells, in(), grid.tile(i), {correction, residual});
    }
  }

  Frame guides;
  Planes<3> light, prediction, correction;
  Plane<float> confirmed, age, samples, variance, residual;
  ResidualCells cells;
};

TEST(ResidualCells, AgreeWithTheirTwinOnEveryTarget) {
  for_each_target([] {
    for (const Extent extent : kSweepExtents) {
      Scene scene(extent);
      scene.load();
      for (int y = 0; y < scene.cells.extent().height; ++y) {
        for (int x = 0; x < scene.cells.extent().width; ++x) {
          const reference::Cell twin = reference::cell(scene.in(), scene.prediction, x, y);
          ASSERT_EQ(scene.cells.guides.surface.id(x, y), twin.id) << x << ", " << y;
          ASSERT_EQ(scene.cells.count(x, y), twin.count);
          const float depth = scene.guides.surface.depth(2 * x, 2 * y);
          ASSERT_EQ(scene.cells.guides.surface.depth(x, y),
                    twin.count > 0.0 ? depth : std::numeric_limits<float>::infinity());
          ASSERT_NEAR(scene.cells.noise(x, y), twin.noise, 1e-5 * twin.noise);
          for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(scene.cells.mean[c](x, y), twin.mean[c], 1e-6);
          }
        }
      }
    }
  });
}

TEST(ResidualCells, SpreadAsTheirTwinOnEveryTarget) {
  for_each_target([] {
    for (const Extent extent : kSweepExtents) {
      Scene scene(extent);
      scene.load();
      const Plane<float> residual = scene.residual.clone();
      scene.spread();
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const auto twin = reference::spread(scene.cells, scene.in(), x, y);
          for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_NEAR(scene.correction[c](x, y), twin[c], 2e-6) << x << ", " << y;
          }
          const double luminance = 0.2126 * twin[0] + 0.7152 * twin[1] + 0.0722 * twin[2];
          ASSERT_NEAR(scene.residual(x, y), residual(x, y) - luminance, 2e-6);
        }
      }
    }
  });
}

TEST(ResidualCells, GiveAConstantResidualBackToEveryConfirmedPixel) {
  Scene scene({67, 41});
  scene.load();
  for (std::size_t c = 0; c < 3; ++c) scene.cells.mean[c].fill(0.75f);
  scene.spread();
  std::int64_t left_out = 0, confirmed = 0;
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 67; ++x) {
      if (scene.confirmed(x, y) == 0.0f) {
        ASSERT_EQ(scene.correction[0](x, y), 0.0f);
        continue;
      }
      ++confirmed;
      const float given = scene.correction[2](x, y);
      if (given == 0.0f) {
        ++left_out;  // no cell around has its object
      } else {
        ASSERT_NEAR(given, 0.75f, 1e-6f);
      }
    }
  }
  EXPECT_GT(confirmed, 1000);
  EXPECT_LT(left_out, confirmed / 20);
}

// Two tiles and the beginning of a third, of which every second block column differs.
TEST(ResidualCells, BlocksAreSignificantWhereTheirMeanIsBeyondItsNoise) {
  const Extent extent{613, 19};
  Scene scene(extent);
  scene.confirmed.fill(1.0f);
  scene.samples.fill(1.0f);
  scene.age.fill(1e6f);
  scene.variance.fill(1.0f);
  // Means of 64 pixels have a standard deviation of 1/8: 3/8 is where chance ends.
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) scene.residual(x, y) = x % 16 < 8 ? 0.37f : 0.38f;
  }
  const auto count = [&] {
    std::array<BlockCounts, 3> counts{};
    test_blocks(scene.in(), scene.residual, {0, 0, extent.width, extent.height, 0}, 288, counts);
    return counts;
  };
  for_each_target([&] {
    const auto counts = count();
    for (const std::size_t tile : {0U, 1U}) {
      // 36 blocks in each of three rows; of the last, only three rows of pixels.
      EXPECT_EQ(counts[tile].all, 3 * 36);
      EXPECT_EQ(counts[tile].significant, 2 * 18);
      EXPECT_EQ(counts[tile].confirmed, 288 * 19);
    }
    // 37 columns: of the last block five, in the last row 15 pixels, too few to ask.
    EXPECT_EQ(counts[2].all, 3 * 5 - 1);
    EXPECT_EQ(counts[2].confirmed, 37 * 19);
  });
  // Too few pixels left to ask.
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) scene.confirmed(x, y) = y % 8 == 0 ? 1.0f : 0.0f;
  }
  for_each_target([&] { EXPECT_EQ(count()[1].all, 0); });
}

}  // namespace
}  // namespace eigenlight
