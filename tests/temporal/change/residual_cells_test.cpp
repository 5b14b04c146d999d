#include "temporal/change/residual_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/reference/residual_cells.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Tilted planes; some pixels are unconfirmed and have NaN light.
struct Scene {
  explicit Scene(Extent extent)
      : guides(make_random_frame({.extent = extent, .disturbed = false, .non_finite = false}, 2)),
        residual(make_planes<3>(extent)),
        correction(make_planes<3>(extent)),
        age(random_plane(extent, 3, 1.0f, 40.0f)),
        samples(random_plane(extent, 4, 1.0f, 3.0f)),
        variance(random_plane(extent, 5, 0.1f, 2.0f)),
        innovation(random_plane(extent, 6, -1.0f, 1.0f)),
        cells(extent) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        PixelRandom random(9, x, y);
        const bool used = guides.surface.id(x, y) != 0 && random.uniform() < 0.8f;
        for (auto& plane : residual) plane(x, y) = used ? random.between(-2.0f, 2.0f) : kNan;
        if (!used) {
          samples(x, y) = 0.0f;
          innovation(x, y) = kNan;
        }
      }
    }
    cells.set_camera(guides.camera);
  }
  [[nodiscard]] CorrectionInputs in() const {
    return {guides, residual, innovation, age, samples, variance};
  }
  void load() {
    for_each_tile(stage_tiles(cells.extent()), [&](const Rect& tile) {
      place_cells(guides.surface, tile, cells);
      load_cells(in(), tile, cells);
    });
  }
  void spread() {
    for_each_tile(TileGrid(guides.extent(), 32, 32), [&](const Rect& tile) {
      spread_cells(std::array{SpreadLayer{cells, {correction, innovation}}}, guides, tile);
    });
  }

  Frame guides;
  Planes<3> residual, correction;
  Plane<float> age, samples, variance, innovation;
  ResidualCells cells;
};

EL_KERNEL_TEST(ResidualCells, LoadedCellsMatchTheReference) {
  const Scene before(extent);
  on_every_target([&] {
    Scene scene(extent);
    scene.load();
    for (int y = 0; y < scene.cells.extent().height; ++y) {
      for (int x = 0; x < scene.cells.extent().width; ++x) {
        const reference::Cell twin = reference::cell(before.in(), x, y);
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
  });
}

EL_KERNEL_TEST(ResidualCells, SpreadCellsMatchTheReference) {
  Scene before(extent);
  before.load();
  const auto mean = [&](std::size_t c, int x, int y) { return before.cells.mean[c](x, y); };
  on_every_target([&] {
    Scene scene(extent);
    scene.load();
    scene.spread();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const auto twin = reference::spread(before.cells.guides, mean, before.in(), x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_NEAR(scene.correction[c](x, y), twin[c], 2e-6) << x << ", " << y;
        }
        const double luminance = 0.2126 * twin[0] + 0.7152 * twin[1] + 0.0722 * twin[2];
        const float innovation = before.innovation(x, y);
        if (std::isnan(innovation)) {
          ASSERT_TRUE(std::isnan(scene.innovation(x, y)));
        } else {
          ASSERT_NEAR(scene.innovation(x, y), innovation - luminance, 2e-6);
        }
      }
    }
  });
}

TEST(ResidualCells, ConfirmedPixelsReceiveAConstantResidual) {
  Scene scene({67, 41});
  scene.load();
  for (std::size_t c = 0; c < 3; ++c) scene.cells.mean[c].fill(0.75f);
  scene.spread();
  std::int64_t left_out = 0, confirmed = 0;
  for (int y = 0; y < 41; ++y) {
    for (int x = 0; x < 67; ++x) {
      if (std::isnan(scene.innovation(x, y))) {
        ASSERT_EQ(scene.correction[0](x, y), 0.0f);
        continue;
      }
      ++confirmed;
      const float given = scene.correction[2](x, y);
      if (given == 0.0f) {
        ++left_out;  // no cell around it shows its object
      } else {
        ASSERT_NEAR(given, 0.75f, 1e-6f);
      }
    }
  }
  EXPECT_GT(confirmed, 1000);
  EXPECT_LT(left_out, confirmed / 20);
}

// 77 x 3 blocks of pixels whose innovations have a variance of 1.
struct BlockScene : Scene {
  BlockScene() : Scene({613, 19}) {
    samples.fill(1.0f);
    age.fill(1e6f);
    variance.fill(1.0f);
  }
  template <typename Value>
  void set_innovation(const Value& value) {
    for (int y = 0; y < innovation.height(); ++y) {
      for (int x = 0; x < innovation.width(); ++x) innovation(x, y) = value(x, y);
    }
  }
  // The row of blocks that starts at y.
  [[nodiscard]] std::vector<ResidualBlock> row(int y) const {
    std::vector<ResidualBlock> blocks(77);
    test_blocks(in(), {0, y, innovation.width(), std::min(y + 8, innovation.height())}, blocks);
    return blocks;
  }
};

// Means of 64 pixels have a standard deviation of 1/8, and the limit is three of them: 3/8. Every
// second column of blocks is beyond.
TEST(ResidualCells, BlocksAreSignificantIfTheirMeanExceedsItsNoise) {
  BlockScene scene;
  scene.set_innovation([](int x, int) { return x % 16 < 8 ? 0.37f : 0.38f; });
  for_each_target([&] {
    const auto row = [&](int y) { return scene.row(y); };
    const auto blocks = row(8);
    for (std::size_t i = 0; i < 76; ++i) {
      EXPECT_EQ(blocks[i].confirmed, 64);
      EXPECT_TRUE(blocks[i].is_asked);
      EXPECT_EQ(blocks[i].is_significant, i % 2 == 1) << i;
    }
    // The last block has five columns. In the last row of blocks it has 15 pixels, which is too
    // few.
    EXPECT_EQ(blocks[76].confirmed, 40);
    EXPECT_TRUE(blocks[76].is_asked);
    EXPECT_EQ(row(16)[75].confirmed, 24);
    EXPECT_EQ(row(16)[76].confirmed, 15);
    EXPECT_FALSE(row(16)[76].is_asked);
  });
}

TEST(ResidualCells, BlocksOfFewConfirmedPixelsAreNotTested) {
  BlockScene scene;
  scene.set_innovation([](int, int y) { return y % 8 == 0 ? 5.0f : kNan; });
  for_each_target([&] {
    for (const ResidualBlock& block : scene.row(0)) {
      EXPECT_LE(block.confirmed, 8);
      EXPECT_FALSE(block.is_asked || block.is_significant);
    }
  });
}

}  // namespace
}  // namespace eigenlight
