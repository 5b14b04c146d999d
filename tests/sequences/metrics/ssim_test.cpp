#include "sequences/metrics/ssim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace eigenlight {
namespace {

Plane<double> filled(Extent extent, double value) {
  Plane<double> plane(extent);
  plane.fill(value);
  return plane;
}

Plane<double> random_plane(Extent extent, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Plane<double> plane(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) plane(x, y) = uniform(engine);
  }
  return plane;
}

// SSIM of one pixel as Wang et al. 2004 write it: two passes, two-dimensional window.
double direct_ssim(const Plane<double>& a, const Plane<double>& b, int cx, int cy) {
  double total = 0, mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, covariance = 0;
  const auto each = [&](const auto& body) {
    for (int y = cy - 5; y <= cy + 5; ++y) {
      for (int x = cx - 5; x <= cx + 5; ++x) {
        const double r2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
        body(std::exp(-r2 / (2 * 1.5 * 1.5)), a(x, y), b(x, y));
      }
    }
  };
  each([&](double g, double, double) { total += g; });
  each([&](double g, double va, double vb) { mean_a += g / total * va, mean_b += g / total * vb; });
  each([&](double g, double va, double vb) {
    var_a += g / total * (va - mean_a) * (va - mean_a);
    var_b += g / total * (vb - mean_b) * (vb - mean_b);
    covariance += g / total * (va - mean_a) * (vb - mean_b);
  });
  return (2 * mean_a * mean_b + 1e-4) * (2 * covariance + 9e-4) /
         ((mean_a * mean_a + mean_b * mean_b + 1e-4) * (var_a + var_b + 9e-4));
}

TEST(Ssim, IsThePaperFormulaInsideTheImage) {
  constexpr Extent kSize{24, 17};
  const Plane<double> a = random_plane(kSize, 1), b = random_plane(kSize, 2);
  const SsimMaps maps = ssim_maps({a, b, filled(kSize, 1.0)});
  for (int y = 5; y < 12; ++y) {
    for (int x = 5; x < 19; ++x) {
      EXPECT_NEAR(maps.luminance(x, y) * maps.structure(x, y), direct_ssim(a, b, x, y), 1e-12);
    }
  }
}

TEST(Ssim, ConstantImagesDifferInLuminanceOnly) {
  constexpr Extent kSize{200, 180};
  const Plane<double> a = filled(kSize, 0.5), b = filled(kSize, 0.25), all = filled(kSize, 1.0);
  const double luminance = (2 * 0.125 + 1e-4) / (0.25 + 0.0625 + 1e-4);
  const SsimPyramid pyramid({a, b, all});
  EXPECT_NEAR(pyramid.ssim(all).value(), luminance, 1e-9);
  // Only the last scale knows luminance.
  EXPECT_NEAR(pyramid.ms_ssim(all).value(), std::pow(luminance, 0.1333), 1e-9);
}

TEST(Ssim, EqualImagesAreOneAtAllScales) {
  constexpr Extent kSize{177, 190};
  const Plane<double> a = random_plane(kSize, 3), all = filled(kSize, 1.0);
  const SsimPyramid pyramid({a, a, all});
  EXPECT_NEAR(pyramid.ssim(all).value(), 1.0, 1e-12);
  EXPECT_NEAR(pyramid.ms_ssim(all).value(), 1.0, 1e-3);  // the weights sum to 1.0001
}

TEST(Ssim, SmallImagesHaveOneScale) {
  for (const Extent size : {Extent{1, 1}, Extent{3, 5}, Extent{175, 300}}) {
    const Plane<double> a = random_plane(size, 4), all = filled(size, 1.0);
    const SsimPyramid pyramid({a, a, all});
    EXPECT_NEAR(pyramid.ssim(all).value(), 1.0, 1e-12);
    EXPECT_FALSE(pyramid.ms_ssim(all).has_value());
  }
}

TEST(Ssim, PixelsOfWeightZeroAreNeverRead) {
  constexpr Extent kSize{32, 32};
  Plane<double> a = random_plane(kSize, 5), weight = filled(kSize, 1.0);
  const Plane<double> b = a.clone();
  a(16, 16) = std::numeric_limits<double>::quiet_NaN();
  weight(16, 16) = 0.0;
  EXPECT_NEAR(SsimPyramid({a, b, weight}).ssim(weight).value(), 1.0, 1e-12);
}

TEST(Ssim, AnEmptySetHasNoFigure) {
  constexpr Extent kSize{180, 180};
  const Plane<double> a = random_plane(kSize, 6), all = filled(kSize, 1.0);
  const SsimPyramid pyramid({a, a, all});
  EXPECT_FALSE(pyramid.ssim(filled(kSize, 0.0)).has_value());
  EXPECT_FALSE(pyramid.ms_ssim(filled(kSize, 0.0)).has_value());
  EXPECT_THROW((void)ssim_maps({a, a, filled({4, 4}, 1.0)}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
