#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/support/analytic_source.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

EigenOptions without_resampling() {
  EigenOptions parts;
  parts.budget.share = 0.0;
  return parts;
}

struct Pictures {
  std::vector<Planes<3>> frames;
  std::vector<FrameReport> reports;
};

Pictures run(const AnalyticOptions& options, const EigenOptions& parts = without_resampling()) {
  AnalyticSource source(options);
  EigenDenoiser denoiser({options.extent, 3}, parts);
  Pictures out;
  while (const Planes<3>* p = denoiser.step(source)) {
    out.frames.push_back({(*p)[0].clone(), (*p)[1].clone(), (*p)[2].clone()});
    out.reports.push_back(denoiser.report());
  }
  return out;
}

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

// Replaces one pixel's indirect light in one frame.
AnalyticOptions with_value(float value, int frame) {
  AnalyticOptions options{.extent = {191, 107}, .frames = 12};
  options.edit = [value, frame](Frame& f) {
    if (f.index == frame) f.lights[0].radiance[1](20, 20) = value;
  };
  return options;
}

TEST(EigenDenoiserStress, WhatIsNotFiniteIsCountedAndStaysAlone) {
  const FloatTrapsOff nan_is_meant;
  const Pictures clean = run(with_value(1.0f, -1));
  for (const float bad : {kNan, -kInf}) {
    const Pictures hit = run(with_value(bad, 5));
    for (std::size_t n = 0; n < 12; ++n) {
      EXPECT_TRUE(all_finite(hit.frames[n]));
      EXPECT_EQ(hit.reports[n].non_finite_pixels, n == 5 ? 1 : 0);
    }
    // The pixel leaves the sums of its coefficient tile, whose window and interpolation reach three
    // tiles far; then come the innovation's window and the filter's reach: below x = 128 in all.
    for (int y = 0; y < 107; ++y) {
      for (int x = 128; x < 191; ++x) ASSERT_EQ(hit.frames[5][1](x, y), clean.frames[5][1](x, y));
    }
    // One sample of 81 less changes little around it, and less as time goes on.
    EXPECT_LT(largest_ratio(hit.frames[5], clean.frames[5], {20, 20}, 16), 0.1f);
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {20, 20}, 16), 0.05f);
  }
}

TEST(EigenDenoiserStress, NewPixelsThatAreNotFiniteDoNotDarkenTheirNeighbors) {
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

TEST(EigenDenoiserStress, HugeValuesDoNotStay) {
  const FloatTrapsOff nan_is_meant;
  const Pictures clean = run(with_value(1.0f, -1));
  for (const float value : {-1e6f, 1e30f, 3e38f}) {
    const Pictures hit = run(with_value(value, 5));
    for (const auto& frame : hit.frames) EXPECT_TRUE(all_finite(frame)) << value;
    // Far away nothing of it is ever seen.
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {150, 60}, 30), 0.05f) << value;
    // What float cannot square counts as not finite, and leaves no trace in the end.
    if (std::abs(value) < 1e18f) continue;
    EXPECT_EQ(hit.reports[5].non_finite_pixels, 1) << value;
    EXPECT_LT(largest_ratio(hit.frames[11], clean.frames[11], {20, 20}, 16), 0.05f) << value;
  }
}

TEST(EigenDenoiserStress, DenormalAndNegativeLightIsLightLikeAny) {
  for (const float scale : {1e-40f, 1e-20f, -1.0f, 1e15f}) {
    AnalyticOptions options{.extent = {65, 17}, .frames = 8};
    options.gain = [scale](int) { return scale; };
    for (const auto& frame : run(options, {}).frames) {
      EXPECT_TRUE(all_finite(frame)) << scale;
      EXPECT_LE(frame[1](30, 8) / scale, 4.0f) << scale;
      EXPECT_GE(frame[1](30, 8) / scale, 0.0f) << scale;
    }
  }
}

TEST(EigenDenoiserStress, FramesWithoutAnyUsablePixelAreSurvived) {
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
  // Frame 6 shows what frame 5 knew, and frame 1 starts.
  EXPECT_EQ(hit.reports[1].new_pixels, 65 * 17);
  EigenOptions history_alone = without_resampling();
  history_alone.look_back = false;
  const Pictures alone = run(options, history_alone);
  EXPECT_LT(largest_ratio(alone.frames[6], alone.frames[5], {30, 8}, 8), 0.02f);
  // Filtered by another earlier picture, the same history looks a little different.
  EXPECT_LT(largest_ratio(hit.frames[6], hit.frames[5], {30, 8}, 8), 0.05f);
}

// A normal of length 1e30 or a negative depth once made NaN of the pixels around, and a normal of
// NaN halved the light of its own pixel.
TEST(EigenDenoiserStress, SurfacesThatCannotBeFollowedKeepTheirOwnLight) {
  AnalyticOptions options{.extent = {65, 40}, .frames = 4};
  options.noise = 0.0f;
  options.pattern = 0.0f;
  for (const float bad : {kNan, kInf, 1e30f, -5.0f, 0.0f, 1e-40f}) {
    for (const bool depth : {false, true}) {
      if (depth && bad == kInf) continue;  // what stands for no surface
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

TEST(EigenDenoiserStress, AFireflyIsCountedAndLeavesNoTrail) {
  const Pictures clean = run(with_value(1.0f, -1)), hit = run(with_value(1e6f, 5));
  EXPECT_EQ(hit.reports[5].bounded_pixels, clean.reports[5].bounded_pixels + 1);
  for (std::size_t n = 5; n < 12; ++n) {
    EXPECT_LT(largest_ratio(hit.frames[n], clean.frames[n], {20, 20}, 16), 1.0f) << n;
  }
}

TEST(EigenDenoiserStress, LightThatIsTheSameEverywhereStaysSoFromTheFirstFrame) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 70};
  options.noise = 0.0f;
  options.pattern = 0.0f;
  for (const auto& frame : run(options).frames) {
    for (int x = 0; x < 65; ++x) ASSERT_NEAR(frame[0](x, 8), 1.0f, 8e-6f);
  }
}

TEST(EigenDenoiserStress, StillScenesDoNotDrift) {
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
