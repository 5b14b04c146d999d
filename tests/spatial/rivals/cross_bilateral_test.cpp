#include "spatial/rivals/cross_bilateral.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "tests/reference/cross_bilateral.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_agreement(Extent extent, const CrossBilateralOptions& options) {
  const SpatialCase c(extent);
  const Planes<3> twin = reference::cross_bilateral(c, options);
  on_every_target([&] {
    CrossBilateral filter(extent, options);
    // The rounding of positions is 1e-7 of the depth; division by the sigma of planes magnifies it.
    EXPECT_TRUE(planes_near(c.run(filter), twin, {1e-4, 1e-6})) << "radius " << options.radius;
  });
}

EL_KERNEL_TEST(CrossBilateral, MatchesTheReference) { expect_agreement(extent, {.radius = 3}); }

TEST(CrossBilateral, MatchesTheReferenceAtWideRadii) {
  expect_agreement({65, 17}, {.radius = 16, .sigma_normal = 0.7f, .sigma_albedo = 0.5f});
  expect_agreement({33, 20}, {.radius = 32, .sigma_plane = 0.3f});
}

// Without differences in the guides, the filter is a Gaussian of sigma radius / 2, cut at the
// radius.
TEST(CrossBilateral, IsAGaussianOnAFlatWall) {
  SpatialCase c = SpatialCase::corner({64, 64});
  for (auto& plane : c.signal) plane.fill(0.0f);
  for (std::size_t i = 0; i < 3; ++i) c.frame.surface.normal[i].fill(i == 2 ? -1.0f : 0.0f);
  c.frame.surface.depth.fill(4.0f);
  c.signal[1](32, 32) = 1.0f;
  CrossBilateral filter(c.extent(), {.radius = 8});
  const Planes<3> out = c.run(filter);
  EXPECT_NEAR(out[1](36, 32) / out[1](32, 32), std::exp(-0.5), 1e-4);
  EXPECT_NEAR(out[1](36, 28) / out[1](32, 32), std::exp(-1.0), 1e-4);
  EXPECT_EQ(out[1](41, 32), 0.0f);
  EXPECT_GT(out[1](40, 40), 0.0f);
}

TEST(CrossBilateral, EveryGuideIsAnEdge) {
  for (const char* guide : {"normal", "depth", "albedo"}) {
    SpatialCase c = SpatialCase::corner({48, 24});
    for (std::size_t i = 0; i < 3; ++i) c.frame.surface.normal[i].fill(i == 2 ? -1.0f : 0.0f);
    c.frame.surface.depth.fill(4.0f);
    for (int y = 0; y < 24; ++y) {
      for (int x = 24; x < 48; ++x) {
        const std::string_view name = guide;
        if (name == "normal") c.frame.surface.normal[0](x, y) = 1.0f;
        if (name == "depth") c.frame.surface.depth(x, y) = 6.0f;
        if (name == "albedo") c.frame.surface.albedo[2](x, y) = 1.5f;
        for (auto& plane : c.signal) plane(x, y) = 3.0f;
      }
    }
    CrossBilateral filter(c.extent(), {.radius = 8, .sigma_normal = 0.2f, .sigma_albedo = 0.2f});
    const Planes<3> out = c.run(filter);
    EXPECT_NEAR(out[0](23, 12), 1.0f, 1e-4f) << guide;
    EXPECT_NEAR(out[0](24, 12), 3.0f, 1e-4f) << guide;
  }
}

TEST(CrossBilateral, RejectsBadOptions) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(CrossBilateral({8, 8}, {.radius = 0}), std::invalid_argument);
  EXPECT_THROW(CrossBilateral({8, 8}, {.radius = 33}), std::invalid_argument);
  EXPECT_THROW(CrossBilateral({8, 8}, {.sigma_normal = 0.0f}), std::invalid_argument);
  EXPECT_THROW(CrossBilateral({8, 8}, {.sigma_plane = kNan}), std::invalid_argument);
  EXPECT_THROW(CrossBilateral({8, 8}, {.sigma_albedo = 11.0f}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
