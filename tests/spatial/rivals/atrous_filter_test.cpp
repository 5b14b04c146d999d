#include "spatial/rivals/atrous_filter.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "tests/reference/atrous_filter.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_agreement(Extent extent, const AtrousFilterOptions& options) {
  const SpatialCase c(extent);
  const Planes<3> twin = reference::AtrousTwin(c, options).run();
  on_every_target([&] {
    AtrousFilter filter(extent, options);
    EXPECT_TRUE(planes_near(c.run(filter), twin, {1e-4, 1e-6})) << options.passes << " passes";
  });
}

EL_KERNEL_TEST(AtrousFilter, MatchesTheReference) { expect_agreement(extent, {.passes = 3}); }

TEST(AtrousFilter, MatchesTheReferenceWithAllPasses) {
  expect_agreement({100, 70}, {.passes = 6, .sigma_color = 2.0f, .sigma_position = 0.5f});
}

// A single bright pixel spreads by the B3-spline with holes.
TEST(AtrousFilter, PointSpreadsByTheB3Spline) {
  SpatialCase c = SpatialCase::corner({64, 64});
  for (auto& plane : c.signal) plane.fill(0.0f);
  for (std::size_t i = 0; i < 3; ++i) c.frame.surface.normal[i].fill(i == 2 ? -1.0f : 0.0f);
  c.frame.surface.depth.fill(4.0f);
  c.signal[1](32, 32) = 256.0f;
  const AtrousFilterOptions wide{.passes = 1, .sigma_color = 1e6f, .sigma_position = 10.0f};
  AtrousFilter once(c.extent(), wide);
  const Planes<3> out = c.run(once);
  EXPECT_NEAR(out[1](32, 32), 36.0f, 0.05f);
  EXPECT_NEAR(out[1](31, 32), 24.0f, 0.05f);
  EXPECT_NEAR(out[1](34, 34), 1.0f, 0.01f);
  EXPECT_EQ(out[1](35, 32), 0.0f);
  AtrousFilterOptions twice = wide;
  twice.passes = 2;
  AtrousFilter second(c.extent(), twice);
  const Planes<3> spread = c.run(second);
  EXPECT_GT(spread[1](38, 38), 0.0f);
  EXPECT_EQ(spread[1](39, 32), 0.0f);
}

TEST(AtrousFilter, SmallColorSigmaKeepsEdgesOfLight) {
  SpatialCase c = SpatialCase::corner({64, 32});
  for (std::size_t i = 0; i < 3; ++i) c.frame.surface.normal[i].fill(i == 2 ? -1.0f : 0.0f);
  c.frame.surface.depth.fill(4.0f);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) c.signal[0](x, y) = c.signal[1](x, y) = 5.0f;
  }
  AtrousFilter keeps(c.extent(), {.passes = 3, .sigma_color = 0.2f});
  AtrousFilter blurs(c.extent(), {.passes = 3, .sigma_color = 1e6f});
  EXPECT_NEAR(c.run(keeps)[0](31, 16), 5.0f, 1e-3f);
  EXPECT_LT(c.run(blurs)[0](31, 16), 4.0f);
}

TEST(AtrousFilter, RejectsBadOptions) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(AtrousFilter({8, 8}, {.passes = 0}), std::invalid_argument);
  EXPECT_THROW(AtrousFilter({8, 8}, {.passes = 7}), std::invalid_argument);
  EXPECT_THROW(AtrousFilter({8, 8}, {.sigma_color = 0.0f}), std::invalid_argument);
  EXPECT_THROW(AtrousFilter({8, 8}, {.sigma_normal = kNan}), std::invalid_argument);
  EXPECT_THROW(AtrousFilter({8, 8}, {.sigma_position = -1.0f}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
