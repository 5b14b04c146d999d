// Gains as ratios of sums of light.
#include "temporal/bases/even_sums.h"

#include <gtest/gtest.h>

#include <limits>

#include "frame/random.h"
#include "temporal/bases/coefficients.h"

namespace eigenlight {
namespace {

constexpr Extent kTile{kCoefficientTile, kCoefficientTile};

// Light of mean `gain` and history of mean 1, each with heavy noise: one in ten pixels holds it
// all.
struct Case {
  BasisField bases{kTile, 1};
  Planes<3> light = make_planes<3>(kTile);
  Plane<float> variance{kTile};

  Case(float gain, std::uint32_t seed) {
    for (int y = 0; y < kTile.height; ++y) {
      for (int x = 0; x < kTile.width; ++x) {
        const auto draw = [&](std::uint32_t key) {
          return to_unit(hash_key(seed, key, x, y)) < 0.1f ? 10.0f : 0.0f;
        };
        bases.ages(x, y)[0] = 4.0f;
        const float before = draw(1), now = gain * draw(2);
        for (int c = 0; c < 3; ++c) {
          bases.value(x, y, c, 0) = before;
          light[c](x, y) = now;
        }
        variance(x, y) = 9.0f;
      }
    }
  }

  [[nodiscard]] TileSums sums() const {
    TileSums sums;
    accumulate_even({bases, light, variance, 1}, Tile{{0, 0, kTile.width, kTile.height}, 0}, sums);
    return sums;
  }
};

double gain_of(const TileSums& sums) { return 1.0 + sums.innovation[0] / sums.gram[0]; }

TEST(EvenSums, GainsHaveNoBiasFromTheNoiseOfHistory) {
  double mean = 0.0;
  constexpr int kDraws = 400;
  for (std::uint32_t seed = 0; seed < kDraws; ++seed) mean += gain_of(Case(1.2f, seed).sums());
  // One draw is off by sqrt(2 * 9 / 1024) = 13 %, the mean of 400 by .7 %.
  EXPECT_NEAR(mean / kDraws, 1.2, 0.03);
}

// What the instrument is for: inner products make the same light darker by the noise of V_0.
TEST(EvenSums, InnerProductsWouldHaveIt) {
  double even = 0.0, inner = 0.0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const Case drawn(1.0f, seed);
    TileSums sums;
    accumulate_tile({drawn.bases, drawn.light, drawn.variance, 1},
                    Tile{{0, 0, kTile.width, kTile.height}, 0}, sums);
    even += gain_of(drawn.sums()) / 50.0;
    inner += gain_of(sums) / 50.0;
  }
  EXPECT_NEAR(even, 1.0, 0.08);
  EXPECT_LT(inner, 0.5);
}

TEST(EvenSums, PixelsWithoutHistoryOrFiniteLightDoNotCount) {
  Case drawn(1.0f, 3);
  const double pixels = drawn.sums().pixels;
  drawn.bases.ages(5, 5)[0] = 0.0f;
  drawn.light[1](6, 6) = std::numeric_limits<float>::quiet_NaN();
  drawn.light[1](7, 7) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(drawn.sums().pixels, pixels - 3.0);
}

}  // namespace
}  // namespace eigenlight
