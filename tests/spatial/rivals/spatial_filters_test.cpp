// Tests that every filter of single frames must pass.
#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "frame/tiles.h"
#include "spatial/rivals/atrous_filter.h"
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"
#include "tests/support/compare.h"
#include "tests/support/extents.h"
#include "tests/support/spatial_case.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Kind {
  std::string name;
  std::function<std::unique_ptr<SpatialFilter>(Extent)> make;
};

template <typename Filter, typename Options>
Kind kind(const std::string& name, const Options& options) {
  return {name, [options](Extent extent) { return std::make_unique<Filter>(extent, options); }};
}

class SpatialFilters : public testing::TestWithParam<Kind> {
 protected:
  [[nodiscard]] static Planes<3> run(const SpatialCase& c) {
    return c.run(*GetParam().make(c.extent()));
  }
};

TEST_P(SpatialFilters, ConstantLightStaysConstantAtAnySize) {
  for (const Extent extent : kSweepExtents) {
    SpatialCase c(extent);
    for (auto& plane : c.signal) plane.fill(2.5f);
    c.weight.fill(1.0f);
    const Planes<3> out = run(c);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const bool surface = c.frame.surface.id(x, y) != 0;
        ASSERT_NEAR(out[1](x, y), surface ? 2.5f : 0.0f, 2e-5f) << x << ", " << y;
      }
    }
  }
}

// Light that differs between two walls follows their edge, and its noise falls on either side.
TEST_P(SpatialFilters, EdgeOfTheGuideIsKeptAndNoiseFalls) {
  SpatialCase c = SpatialCase::corner({128, 48});
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 128; ++x) {
      const float noise = PixelRandom(8, x, y).between(0.8f, 1.2f);
      for (auto& plane : c.signal) plane(x, y) = (x < 64 ? 2.0f : 1.0f) * noise;
    }
  }
  const Planes<3> out = run(c);
  double error = 0.0, before = 0.0;
  for (int y = 0; y < 48; ++y) {
    EXPECT_GT(out[0](63, y), 1.8f);
    EXPECT_LT(out[0](64, y), 1.2f);
    for (int x = 0; x < 128; ++x) {
      const double truth = x < 64 ? 2.0 : 1.0;
      error += std::pow(static_cast<double>(out[0](x, y)) - truth, 2);
      before += std::pow(static_cast<double>(c.signal[0](x, y)) - truth, 2);
    }
  }
  EXPECT_LT(error, 0.05 * before);
}

// Bad values in light without weight, or in guides without surface, leave no trace, and light that
// is not finite counts as light without weight.
TEST_P(SpatialFilters, UnusablePixelsHaveNoInfluence) {
  SpatialCase clean({100, 70});
  for (auto& plane : clean.signal) {
    for (float& v : plane.storage()) v = std::isfinite(v) ? v : 0.5f;
  }
  SpatialCase dirty = SpatialCase({100, 70});
  copy_planes(clean.signal, dirty.signal);
  int spoiled = 0;
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 100; ++x) {
      const float bad[4] = {kNan, kInf, -kInf, 3e38f};
      const auto pick = static_cast<std::size_t>(4.0f * PixelRandom(3, x, y).uniform());
      if (clean.weight(x, y) == 0.0f) {
        dirty.signal[pick % 3](x, y) = bad[pick];
        if (pick < 3) dirty.weight(x, y) = 2.0f;
        ++spoiled;
      }
      if (clean.frame.surface.id(x, y) == 0) {
        dirty.frame.surface.normal[1](x, y) = kNan;
        dirty.frame.surface.albedo[0](x, y) = kInf;
        dirty.weight(x, y) = 7.0f;
      }
    }
  }
  ASSERT_GT(spoiled, 100);
  EXPECT_TRUE(planes_equal(run(dirty), run(clean)));
}

TEST_P(SpatialFilters, HoleIsFilledFromItsSurroundings) {
  SpatialCase c = SpatialCase::corner({64, 32});
  c.signal[2](10, 10) = kNan;
  EXPECT_NEAR(run(c)[2](10, 10), 1.0f, 1e-5f);
}

TEST_P(SpatialFilters, ResultIsZeroWithoutUsablePixels) {
  SpatialCase c({20, 20});
  c.weight.fill(0.0f);
  for (auto& plane : c.signal) plane.fill(kNan);
  EXPECT_TRUE(planes_equal(run(c), make_planes<3>({20, 20})));
}

TEST_P(SpatialFilters, ThreadCountDoesNotChangeTheBits) {
  const SpatialCase c({191, 107});
  set_thread_count(1);
  const auto filter = GetParam().make(c.extent());
  const Planes<3> one = c.run(*filter);
  EXPECT_TRUE(planes_equal(c.run(*filter), one));
  set_thread_count(3);
  EXPECT_TRUE(planes_equal(run(c), one));
  set_thread_count(0);
}

TEST_P(SpatialFilters, RejectsOtherSizesAndItsOwnInput) {
  SpatialCase c({20, 20});
  const auto filter = GetParam().make({20, 20});
  Planes<3> out = make_planes<3>({20, 21});
  EXPECT_THROW(filter->process(c.inputs(), out), std::invalid_argument);
  EXPECT_THROW(filter->process(c.inputs(), c.signal), std::invalid_argument);
  EXPECT_THROW((void)SpatialCase({21, 20}).run(*filter), std::invalid_argument);
  EXPECT_THROW(GetParam().make({0, 8}), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(
    All, SpatialFilters,
    testing::Values(kind<CrossBilateral>("cross_bilateral", CrossBilateralOptions{.radius = 8}),
                    kind<AtrousFilter>("atrous", AtrousFilterOptions{.passes = 4,
                                                                     .sigma_color = 4.0f,
                                                                     .sigma_normal = 0.3f,
                                                                     .sigma_position = 0.1f}),
                    kind<GuidedSpatial>("guided", GuidedOptions{.radius = 8})),
    [](const auto& chosen) { return chosen.param.name; });

}  // namespace
}  // namespace eigenlight
