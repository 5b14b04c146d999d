// Invalid, huge and tiny values in the input of the denoiser.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/temporal/eigen/eigen_runs.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

using test::Pictures;
using test::run;
using test::without_resampling;

// Largest |a / b - 1| of green over the square of the given radius around p.
float largest_ratio(const Planes<3>& a, const Planes<3>& b, glm::ivec2 p, int radius) {
  float largest = 0.0f;
  for (int y = p.y - radius; y <= p.y + radius; ++y) {
    for (int x = p.x - radius; x <= p.x + radius; ++x) {
      largest = std::max(largest, std::abs(a[1](x, y) / b[1](x, y) - 1.0f));
    }
  }
  return largest;
}

// Replaces the light of one pixel in one frame.
AnalyticOptions with_value(float value, int frame) {
  AnalyticOptions options{.extent = {191, 107}, .frames = 12};
  options.edit = [value, frame](Frame& f) {
    if (f.index == frame) f.lights[0].radiance[1](20, 20) = value;
  };
  return options;
}

TEST(EigenDenoiserStress, NonFiniteLightIsCountedAndDoesNotSpread) {
  const FloatTrapsOff nan_is_meant;
  const Pictures clean = run(with_value(1.0f, -1));
  for (const float bad : {kNan, -kInf}) {
    const Pictures hit = run(with_value(bad, 5));
    for (std::size_t n = 0; n < 12; ++n) {
      EXPECT_TRUE(all_finite(hit.frames[n]));
      EXPECT_EQ(hit.reports[n].non_finite_pixels, n == 5 ? 1 : 0);
    }
    // The pixel leaves the sums of its coefficient tile. Their window and interpolation reach three
    // tiles; with the windows of the innovation and the filters, all effects stay below x = 128.
    for (int y = 0; y < 107; ++y) {
      for (int x = 128; x < 191; ++x) ASSERT_EQ(hit.frames[5][1](x, y), clean.frames[5][1](x, y));
    }
    // The windows around it lose one sample of 81, which changes little, and less with time.
    EXPECT_LT(largest_ratio(hit.frames[5], clean.frames[5], {20, 20}, 16), 0.1f);
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {20, 20}, 16), 0.05f);
  }
}

TEST(EigenDenoiserStress, NonFiniteNewPixelDoesNotDarkenItsNeighbors) {
  const FloatTrapsOff nan_is_meant;
  const Pictures clean = run(with_value(1.0f, -1)), hit = run(with_value(kNan, 0));
  EXPECT_TRUE(all_finite(hit.frames[0]));
  EXPECT_EQ(hit.reports[0].non_finite_pixels, 1);
  Planes<3> around = make_planes<3>({191, 107});
  copy_planes(hit.frames[0], around);
  around[1](20, 20) = clean.frames[0][1](20, 20);
  EXPECT_LT(largest_ratio(around, clean.frames[0], {20, 20}, 16), 0.1f);
  EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {20, 20}, 16), 0.05f);
}

TEST(EigenDenoiserStress, HugeValuesLeaveNoTrace) {
  const FloatTrapsOff nan_is_meant;
  const Pictures clean = run(with_value(1.0f, -1));
  for (const float value : {-1e6f, 1e30f, 3e38f}) {
    const Pictures hit = run(with_value(value, 5));
    for (const auto& frame : hit.frames) EXPECT_TRUE(all_finite(frame)) << value;
    // It has no effect far away.
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {150, 60}, 30), 0.05f) << value;
    // Light whose square overflows counts as non-finite and has no effect in the end.
    if (std::abs(value) < 1e18f) continue;
    EXPECT_EQ(hit.reports[5].non_finite_pixels, 1) << value;
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {20, 20}, 16), 0.05f) << value;
  }
}

// Squares of 1e-40 and 1e-20 underflow, which leaves more noise, but less than the 0.083 of a
// frame.
TEST(EigenDenoiserStress, LightOfAnyScaleAndSignIsDenoised) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 8};
  const auto errors = [&](float scale) {
    options.gain = [scale](int) { return scale; };
    std::vector<double> all;
    run(options, {}, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource& s) {
      EXPECT_TRUE(all_finite(out)) << scale;
      all.push_back(relative_error(out, s, d.frame()));
    });
    return all;
  };
  const std::vector<double> usual = errors(1.0f);
  for (const float scale : {1e-40f, 1e-20f, -1.0f, 1e15f}) {
    const std::vector<double> found = errors(scale);
    for (std::size_t n = 0; n < usual.size(); ++n) {
      const bool underflows = std::abs(scale) < 1e-19f;
      EXPECT_LT(found[n], underflows ? 0.06 : 1.2 * usual[n]) << scale << " frame " << n;
    }
  }
}

TEST(EigenDenoiserStress, FrameWithoutUsablePixelsShowsTheHistory) {
  const FloatTrapsOff nan_is_meant;
  AnalyticOptions options{.extent = {65, 17}, .frames = 12};
  options.edit = [](Frame& frame) {
    if (frame.index == 0 || frame.index == 6) frame.lights[0].radiance[2].fill(kNan);
  };
  const Pictures hit = run(options, {});
  EXPECT_EQ(hit.reports[0].non_finite_pixels, 65 * 17);
  EXPECT_EQ(hit.reports[6].non_finite_pixels, 65 * 17);
  EXPECT_EQ(hit.frames[0][1](30, 8), 0.0f);
  for (const auto& frame : hit.frames) EXPECT_TRUE(all_finite(frame));
  // Frame 6 shows the history of frame 5. Frame 1 has no history.
  EXPECT_EQ(hit.reports[1].new_pixels, 65 * 17);
  EigenOptions history_alone = without_resampling();
  history_alone.look_back = false;
  const Pictures alone = run(options, history_alone);
  EXPECT_LT(largest_ratio(alone.frames[6], alone.frames[5], {30, 8}, 8), 0.02f);
  // The same history is filtered with another earlier picture as guide, which adds a little.
  EXPECT_LT(largest_ratio(hit.frames[6], hit.frames[5], {30, 8}, 8), 0.05f);
}

TEST(EigenDenoiserStress, PixelsOfInvalidGeometryKeepTheirOwnLight) {
  AnalyticOptions options{.extent = {65, 40}, .frames = 4};
  options.noise = 0.0f;
  options.pattern = 0.0f;
  for (const float bad : {kNan, kInf, 1e30f, -5.0f, 0.0f, 1e-40f}) {
    for (const bool depth : {false, true}) {
      if (depth && bad == kInf) continue;  // an infinite depth means no surface
      options.edit = [&](Frame& frame) {
        frame.is_static = false;
        (depth ? frame.surface.depth : frame.surface.normal[2])(30, 20) = bad;
      };
      const Pictures hit = run(options);
      for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_EQ(hit.reports[n].unguided_pixels, 1) << bad;
        EXPECT_EQ(hit.reports[n].non_finite_pixels, 0);
        for (int y = 0; y < 40; ++y) {
          for (int x = 0; x < 65; ++x) ASSERT_NEAR(hit.frames[n][1](x, y), 1.0f, 1e-4f) << bad;
        }
      }
    }
  }
}

TEST(EigenDenoiserStress, FireflyIsCountedAndLeavesNoTrail) {
  const Pictures clean = run(with_value(1.0f, -1)), hit = run(with_value(1e6f, 5));
  EXPECT_EQ(hit.reports[5].bounded_pixels, clean.reports[5].bounded_pixels + 1);
  for (std::size_t n = 5; n < 12; ++n) {
    EXPECT_LT(largest_ratio(hit.frames[n], clean.frames[n], {20, 20}, 16), 1.0f) << n;
  }
}

TEST(EigenDenoiserStress, ConstantLightStaysConstant) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 70};
  options.noise = 0.0f;
  options.pattern = 0.0f;
  for (const auto& frame : run(options).frames) {
    for (int x = 0; x < 65; ++x) ASSERT_NEAR(frame[0](x, 8), 1.0f, 8e-6f);
  }
}

TEST(EigenDenoiserStress, StillSceneDoesNotDrift) {
  AnalyticOptions options{.extent = {33, 17}, .frames = 900};
  AnalyticSource source(options);
  EigenDenoiser denoiser({options.extent, 3}, {});
  double bias = 0.0, frames = 0.0;
  while (const Planes<3>* out = denoiser.step(source)) {
    ASSERT_TRUE(all_finite(*out));
    if (denoiser.report().frame < 500) continue;
    bias += static_cast<double>((*out)[1](16, 8) / source.truth({16, 8}, 1, 0)) - 1.0;
    frames += 1.0;
  }
  EXPECT_NEAR(bias / frames, 0.0, 0.02);
}

}  // namespace
}  // namespace eigenlight
