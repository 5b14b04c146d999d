#include "temporal/bases/coefficients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frame/float_traps.h"
#include "tests/reference/coefficients.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

// The inputs of solve_coefficients() from a frame and bases.
struct Scene {
  explicit Scene(Extent extent, int bases)
      : frame(make_random_frame({.extent = extent, .sky = false, .non_finite = false}, 2)),
        variance(random_plane(extent, 5, 0.05f, 0.6f)),
        field(random_bases(extent, bases, 8)),
        coefficients(extent, bases) {}

  // Light = V_0 + sum_k delta_k V_k + noise of the given standard deviation.
  void set_light(const std::vector<float>& delta, float noise, std::uint32_t seed = 1) {
    for (int y = 0; y < frame.extent().height; ++y) {
      for (int x = 0; x < frame.extent().width; ++x) {
        PixelRandom random(seed, x, y);
        for (int c = 0; c < 3; ++c) {
          float u = field.value(x, y, c, 0) + noise * random.between(-1.732f, 1.732f);
          for (int k = 0; k < field.bases(); ++k) {
            u += delta[static_cast<std::size_t>(k)] * field.value(x, y, c, k);
          }
          frame.lights[0].radiance[static_cast<std::size_t>(c)](x, y) = u;
        }
      }
    }
  }

  [[nodiscard]] std::vector<TileSums> sums() const {
    const TileGrid& grid = coefficients.grid();
    std::vector<TileSums> out(static_cast<std::size_t>(grid.count()));
    for (int i = 0; i < grid.count(); ++i) {
      TileSums& sums = out[static_cast<std::size_t>(i)];
      accumulate_tile({field, frame.lights[0].radiance, variance}, grid.tile(i), sums);
      admit_outliers({field, frame.lights[0].radiance, variance}, grid.tile(i), sums);
    }
    return out;
  }

  void solve(const ShrinkOptions& options = {}) {
    solve_coefficients(sums(), {}, options, coefficients);
  }

  // basis k of all pixels: a times basis i plus b times basis j.
  void combine(int k, float a, int i, float b, int j) {
    for (int y = 0; y < frame.extent().height; ++y) {
      for (int x = 0; x < frame.extent().width; ++x) {
        for (int c = 0; c < 3; ++c) {
          field.value(x, y, c, k) = a * field.value(x, y, c, i) + b * field.value(x, y, c, j);
        }
      }
    }
  }

  Frame frame;
  Plane<float> variance;
  BasisField field;
  CoefficientField coefficients;
};

void expect_agreement(Extent extent, int bases, const ShrinkOptions& options, double expected) {
  Scene scene(extent, bases);
  scene.set_light({0.3f, -0.2f, 0.1f, 0.0f, 0.4f, -0.3f, 0.2f, 0.1f}, 0.5f);
  const auto sums = scene.sums();
  const TileGrid& grid = scene.coefficients.grid();
  const auto n = static_cast<std::size_t>(bases);
  const std::vector<double> squares(expected > 0.0 ? sums.size() * n : 0, expected);
  solve_coefficients(sums, squares, options, scene.coefficients);
  for (int i = 0; i < grid.count(); ++i) {
    const auto own = std::span<const double>(squares).first(squares.empty() ? 0 : n);
    const auto wanted =
        reference::coefficients(reference::window(sums, grid, i), {options, own}, bases);
    for (std::size_t k = 0; k < n; ++k) {
      // The solver's ridge of 1e-6 moves deltas by about 1e-6 of their size.
      EXPECT_NEAR(scene.coefficients.tile(i)[k], wanted[k], 2e-5) << "tile " << i << " k " << k;
    }
  }
}

TEST(SolveCoefficients, MatchesTheReference) {
  for (const Extent extent : kSweepExtents) {
    if (extent.pixels() < 100) continue;  // too few equations for the elimination of the reference
    for (const int bases : {1, 3, kMaxBases}) {
      expect_agreement(extent, bases, {0.0}, 0.0);
      expect_agreement(extent, bases, {}, 0.0);
      expect_agreement(extent, bases, {}, 1e-3);
    }
  }
}

TEST(SolveCoefficients, BasesInUseAreShrunkLess) {
  Scene scene({65, 17}, 2);
  scene.set_light({0, 0.02f}, 0.5f);
  const auto sums = scene.sums();
  const auto second = [&](double expected) {
    std::vector<double> squares(2 * sums.size(), 0.0);
    for (std::size_t i = 0; i < sums.size(); ++i) squares[2 * i + 1] = expected;
    solve_coefficients(sums, squares, {}, scene.coefficients);
    return std::abs(scene.coefficients.tile(0)[1]);
  };
  EXPECT_LT(second(0.0), second(1e-3));
  EXPECT_LT(second(1e-3), second(1.0));
}

TEST(SolveCoefficients, GainIsNeverNegative) {
  Scene scene({65, 17}, 1);
  scene.set_light({-3.0f}, 0.0f);
  scene.solve();
  EXPECT_EQ(scene.coefficients.tile(0)[0], -1.0f);
}

TEST(SolveCoefficients, RecoversAKnownGain) {
  for (const float gain : {0.25f, 0.5f, 2.0f, 8.0f}) {
    Scene scene({191, 107}, 3);
    scene.set_light({gain - 1.0f, 0, 0}, 0.0f);
    scene.solve();
    for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
      EXPECT_NEAR(1.0f + scene.coefficients.tile(i)[0], gain, 0.01f * std::abs(gain - 1.0f));
    }
  }
}

// Gains are stored as offsets from 1, which limits their precision to 3e-8.
TEST(SolveCoefficients, RecoversExtremeGains) {
  for (const int bases : {1, 3}) {
    for (const float gain : {1e-6f, 1e-3f, 1e6f}) {
      Scene scene({65, 33}, bases);
      for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 65; ++x) {
          const float noise = PixelRandom(7, x, y).between(0.2f, 1.8f);
          for (int c = 0; c < 3; ++c) {
            const float light = scene.field.value(x, y, c, 0);
            scene.frame.lights[0].radiance[static_cast<std::size_t>(c)](x, y) =
                gain * noise * light;
          }
        }
      }
      scene.solve();
      for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
        EXPECT_NEAR(1.0f + scene.coefficients.tile(i)[0], gain, 0.1f * gain) << bases;
      }
    }
  }
}

// Three pixels of noise often agree on a gain.
TEST(SolveCoefficients, ThreePixelsGiveNoGain) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Scene scene({3, 1}, 1);
    scene.set_light({0.0f}, 0.5f, seed);
    scene.solve();
    EXPECT_EQ(scene.coefficients.tile(0)[0], 0.0f) << seed;
  }
}

TEST(SolveCoefficients, RecoversAKnownMixtureOfBases) {
  Scene scene({191, 107}, 3);
  scene.set_light({0.5f, -0.7f, 0.3f}, 0.0f);
  scene.solve({0.0});
  for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
    const auto tile = scene.coefficients.tile(i);
    EXPECT_NEAR(tile[0], 0.5f, 1e-5f);
    EXPECT_NEAR(tile[1], -0.7f, 1e-5f);
    EXPECT_NEAR(tile[2], 0.3f, 1e-5f);
  }
}

TEST(SolveCoefficients, NoiseGivesMostlyZeros) {
  int zero = 0, all = 0;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    Scene scene({191, 107}, 3);
    scene.set_light({0, 0, 0}, 0.5f, seed);
    scene.solve();
    for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
      for (const float delta : scene.coefficients.tile(i)) {
        zero += delta == 0.0f ? 1 : 0;
        ++all;
        EXPECT_LT(std::abs(delta), 0.2f);
      }
    }
  }
  // 4 variances are subtracted, so 4.6 % of normal coefficients, those beyond 2 sigma, survive.
  EXPECT_GT(zero, all * 88 / 100);
  EXPECT_LT(zero, all);
}

TEST(SolveCoefficients, BasesWithoutEnergyGetZero) {
  Scene full({65, 17}, 1), wide({65, 17}, 4);
  wide.combine(1, 0, 1, 0, 2);
  wide.combine(2, 0, 1, 0, 2);
  wide.combine(3, 0, 1, 0, 2);
  // The same V_0 in both.
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 65; ++x) {
      full.field.age(x, y) = wide.field.age(x, y);
      for (int c = 0; c < 3; ++c) full.field.value(x, y, c, 0) = wide.field.value(x, y, c, 0);
    }
  }
  full.set_light({1}, 0.2f);
  wide.set_light({1, 0, 0, 0}, 0.2f);
  full.solve();
  wide.solve();
  for (int i = 0; i < full.coefficients.grid().count(); ++i) {
    EXPECT_NEAR(wide.coefficients.tile(i)[0], full.coefficients.tile(i)[0], 1e-6f);
    for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(wide.coefficients.tile(i)[k], 0.0f);
  }
}

// Coefficients of parallel bases must stay small, and their sum must be right.
TEST(SolveCoefficients, DuplicateAndNearlyParallelBasesShareTheLight) {
  for (const float apart : {0.0f, 1e-6f, 1e-3f}) {
    Scene scene({65, 17}, 3);
    scene.combine(1, 1.0f, 0, apart, 2);
    scene.set_light({0.6f, 0, 0}, 0.0f);
    scene.solve({0.0});
    for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
      const auto tile = scene.coefficients.tile(i);
      for (const float delta : tile) EXPECT_LT(std::abs(delta), 10.0f) << apart;
      EXPECT_NEAR(tile[0] + tile[1], 0.6f, 1e-2f) << apart;
    }
  }
}

TEST(SolveCoefficients, EmptySumsGiveZeros) {
  CoefficientField field({65, 17}, 3);
  const auto count = static_cast<std::size_t>(field.grid().count());
  field.tile(0)[0] = 3.0f;
  solve_coefficients(std::vector<TileSums>(count), {}, {}, field);
  for (int i = 0; i < field.grid().count(); ++i) {
    for (const float delta : field.tile(i)) EXPECT_EQ(delta, 0.0f);
  }
}

TEST(SolveCoefficients, RejectsWrongNumbersOfSums) {
  CoefficientField field({65, 17}, 3);
  const auto count = static_cast<std::size_t>(field.grid().count());
  EXPECT_THROW(solve_coefficients(std::vector<TileSums>(count + 1), {}, {}, field),
               std::invalid_argument);
  const std::vector<double> expected(3 * count - 1);
  EXPECT_THROW(solve_coefficients(std::vector<TileSums>(count), expected, {}, field),
               std::invalid_argument);
}

TEST(ShrinkOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(ShrinkOptions{-1.0}.validate(), std::invalid_argument);
  EXPECT_THROW(ShrinkOptions{101.0}.validate(), std::invalid_argument);
  EXPECT_THROW(ShrinkOptions{std::nan("")}.validate(), std::invalid_argument);
  EXPECT_NO_THROW(ShrinkOptions{}.validate());
}

}  // namespace
}  // namespace eigenlight
