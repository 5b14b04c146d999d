#include "temporal/bases/tile_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/reference/tile_sums.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

// Sums along a row of 64 terms are in float. 1e-5 of the sum of magnitudes bounds their rounding
// for every order of summation.
constexpr double kTolerance = 1e-5;

void expect_sums_near(const TileSums& found, const TileSums& wanted, int bases) {
  EXPECT_EQ(found.pixels, wanted.pixels);
  for (int j = 0; j < bases; ++j) {
    const auto jj = static_cast<std::size_t>(packed(j, j));
    // Cauchy-Schwarz bounds the magnitudes of the terms of mixed sums.
    const auto at = static_cast<std::size_t>(j);
    EXPECT_NEAR(found.innovation[at], wanted.innovation[at],
                kTolerance * std::sqrt(wanted.scatter_rr[at] * wanted.pixels) + 1e-300)
        << "basis " << j;
    EXPECT_NEAR(found.scatter_rr[at], wanted.scatter_rr[at], kTolerance * wanted.scatter_rr[at]);
    EXPECT_NEAR(found.scatter_r0[at], wanted.scatter_r0[at],
                kTolerance * std::sqrt(wanted.scatter_rr[at] * wanted.scatter_00[at]));
    EXPECT_NEAR(found.scatter_00[at], wanted.scatter_00[at], kTolerance * wanted.scatter_00[at]);
    for (int i = 0; i <= j; ++i) {
      const auto ii = static_cast<std::size_t>(packed(i, i));
      const auto ij = static_cast<std::size_t>(packed(i, j));
      EXPECT_NEAR(found.gram[ij], wanted.gram[ij],
                  kTolerance * std::sqrt(wanted.gram[ii] * wanted.gram[jj]))
          << i << ", " << j;
    }
  }
}

EL_KERNEL_TEST(TileSums, MatchTheReference) {
  const FloatTrapsOff nan_is_meant;
  const Frame frame = make_random_frame({.extent = extent}, 2);
  const Plane<float> variance = random_plane(extent, 5, 0.05f, 0.6f);
  for (const int bases : {1, 3, kMaxBases}) {
    const BasisField field = random_bases(extent, bases, 8);
    const SumInputs in{field, frame.lights[0].radiance, variance};
    for (const int side : {32, kSegment}) {
      const TileGrid grid(extent, side, 32);
      PerTile<TileSums> wanted(grid);
      for (int i = 0; i < grid.count(); ++i) wanted[i] = reference::tile_sums(in, grid.tile(i));
      on_every_target([&] {
        PerTile<TileSums> sums(grid);
        for_each_tile(grid, [&](const Tile& tile) {
          accumulate_tile(in, tile, sums[tile]);
          admit_outliers(in, tile, sums[tile]);
        });
        for (int i = 0; i < grid.count(); ++i) expect_sums_near(sums[i], wanted[i], bases);
      });
    }
  }
}

TEST(TileSums, AccumulateAddsToExistingSums) {
  const Extent extent{32, 32};
  const Frame frame = make_random_frame({.extent = extent}, 2);
  const Plane<float> variance = random_plane(extent, 5, 0.05f, 0.6f);
  const BasisField field = random_bases(extent, 2, 8);
  TileSums once, twice;
  accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 0, 32, 32}, once);
  accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 0, 32, 16}, twice);
  accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 16, 32, 32}, twice);
  for (std::size_t i = 0; i < once.gram.size(); ++i) {
    EXPECT_DOUBLE_EQ(twice.gram[i], once.gram[i]);
  }
  TileSums added = once;
  added += once;
  EXPECT_EQ(added.gram[0], 2.0 * once.gram[0]);
  EXPECT_EQ(added.innovation[1], 2.0 * once.innovation[1]);
  EXPECT_EQ(added.scatter_rr[1], 2.0 * once.scatter_rr[1]);
  EXPECT_EQ(added.pixels, 2.0 * once.pixels);
}

// Missing history and non-finite light each exclude a pixel.
TEST(TileSums, LeaveOutUnusablePixels) {
  const FloatTrapsOff nan_is_meant;
  const Extent extent{5, 3};
  Frame frame = make_random_frame({.extent = extent, .sky = false, .non_finite = false}, 2);
  const Plane<float> variance = random_plane(extent, 5, 0.05f, 0.6f);
  BasisField field(extent, 2);
  fill_bases(field, 1.0f);
  const auto pixels = [&] {
    TileSums sums;
    accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 0, 5, 3}, sums);
    EXPECT_TRUE(std::isfinite(sums.gram[0]));
    EXPECT_TRUE(std::isfinite(sums.innovation[0]));
    EXPECT_TRUE(std::isfinite(sums.scatter_rr[0]));
    return sums.pixels;
  };
  for_each_target([&] {
    EXPECT_EQ(pixels(), 15.0);
    field.age(4, 2) = 0.0f;
    EXPECT_EQ(pixels(), 14.0);
    field.age(4, 2) = 1.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      const float kept = frame.lights[0].radiance[c](2, 1);
      for (const float bad :
           {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
            -std::numeric_limits<float>::infinity()}) {
        frame.lights[0].radiance[c](2, 1) = bad;
        EXPECT_EQ(pixels(), 14.0);
      }
      frame.lights[0].radiance[c](2, 1) = kept;
    }
  });
}

TEST(TileSums, GiveTheGainOfTheLight) {
  // With u = 1.5 V_0 everywhere, <V_0, u - V_0> is half of <V_0, V_0>.
  const Extent extent{32, 32};
  Frame frame = make_random_frame({.extent = extent, .sky = false, .non_finite = false}, 2);
  const Plane<float> variance = random_plane(extent, 5, 0.05f, 0.6f);
  BasisField field = random_bases(extent, 1, 8);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      for (int c = 0; c < 3; ++c) {
        frame.lights[0].radiance[static_cast<std::size_t>(c)](x, y) =
            1.5f * field.value(x, y, c, 0);
      }
    }
  }
  TileSums sums;
  accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 0, 32, 32}, sums);
  EXPECT_GT(sums.gram[0], 0.0);
  EXPECT_NEAR(sums.innovation[0], 0.5 * sums.gram[0], 1e-5 * sums.gram[0]);
}

// One row of outliers has little influence; half a tile of them is a change of light.
TEST(TileSums, FewOutliersLoseTheirInfluence) {
  const Extent extent{32, 32};
  Frame frame = make_random_frame({.extent = extent, .sky = false, .non_finite = false}, 2);
  BasisField field(extent, 1);
  fill_bases(field, 1.0f);
  Plane<float> variance(extent);
  variance.fill(0.01f);
  const auto gain = [&](int rows) {
    for (auto& plane : frame.lights[0].radiance) {
      plane.fill(1.0f);
      for (int y = 0; y < rows; ++y) std::fill(plane.row(y), plane.row(y) + 32, -5.0f);
    }
    TileSums sums;
    // The sums come in two parts, but the share of outliers is that of the whole tile.
    accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 0, 32, 1}, sums);
    accumulate_tile({field, frame.lights[0].radiance, variance}, {0, 1, 32, 32}, sums);
    admit_outliers({field, frame.lights[0].radiance, variance}, {0, 0, 32, 32}, sums);
    return 1.0 + sums.innovation[0] / sums.gram[0];
  };
  for_each_target([&] {
    EXPECT_NEAR(gain(1), 1.0, 0.02);  // with full influence it would be 1 - 6 / 32
    EXPECT_NEAR(gain(16), -2.0, 1e-5);
  });
}

TEST(TileSums, PackedTriangleHasEachPairOnce) {
  int next = 0;
  for (int j = 0; j < kMaxBases; ++j) {
    for (int i = 0; i <= j; ++i) EXPECT_EQ(packed(i, j), next++);
  }
  EXPECT_EQ(static_cast<std::size_t>(next), TileSums{}.gram.size());
}

}  // namespace
}  // namespace eigenlight
