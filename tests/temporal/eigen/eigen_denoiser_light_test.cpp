// How the denoiser follows camera and light.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "frame/float_traps.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/targets.h"
#include "tests/temporal/eigen/eigen_runs.h"

namespace eigenlight {
namespace {

using test::run;
using test::temporal_only;
using test::without_resampling;

constexpr float kInf = std::numeric_limits<float>::infinity();

double mean_age(const EigenDenoiser& denoiser) {
  double sum = 0.0;
  const Plane<float>& age = denoiser.age();
  for (int y = 0; y < age.height(); ++y) {
    for (int x = 0; x < age.width(); ++x) sum += static_cast<double>(age(x, y));
  }
  return sum / static_cast<double>(age.extent().pixels());
}

TEST(EigenDenoiser, HistoryFollowsASlidingCamera) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 24};
  options.slide = {1.0f, 0.0f};  // whole pixels: nothing is blurred by the warp
  run(options, temporal_only(), [&](const auto& out, const auto& d, const auto& s) {
    if (d.report().frame == 0) return;
    // What was at p + slide: the rightmost column is new in every frame.
    EXPECT_EQ(d.report().new_pixels, 64);
    EXPECT_EQ(d.age()(95, 30), 1.0f);
    if (d.report().frame < 23) return;
    EXPECT_GT(mean_age(d), 12.0);
    EXPECT_LT(relative_error(out, s, d.frame()), 0.25 / 3.0 / 8.0);
  });
}

TEST(EigenDenoiser, StepOfLightIsFollowedWithinTwoFrames) {
  for (const float gain : {0.5f, 2.0f}) {
    AnalyticOptions options{.extent = {96, 64}, .frames = 23};
    options.gain = [gain](int frame) { return frame < 20 ? 1.0f : gain; };
    double before = 0.0;
    run(options, without_resampling(), [&](const auto& out, const auto& d, const auto& s) {
      const double error = relative_error(out, s, d.frame());
      if (d.report().frame == 19) before = error;
      if (d.report().frame < 21) return;
      EXPECT_NEAR(relative_bias(out, s, d.frame()), 0.0, 0.02) << gain;
      EXPECT_LT(error, 2.0 * before + 1e-4) << gain << " frame " << d.report().frame;
      // Followed by a gain, not by forgetting.
      EXPECT_GT(mean_age(d), 8.0) << gain;
    });
  }
}

TEST(EigenDenoiser, LightThatGoesOffAndOnIsFollowed) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 30};
  options.gain = [](int frame) { return frame / 6 % 2 == 0 ? 1.0f : 0.0f; };
  run(options, {}, [&](const auto& out, const auto& d, const auto& s) {
    EXPECT_TRUE(all_finite(out)) << d.report().frame;
    if (d.report().frame % 6 < 2) return;
    if (options.gain(d.report().frame) > 0.0f) {
      EXPECT_NEAR(relative_bias(out, s, d.frame()), 0.0, 0.1) << d.report().frame;
    } else {
      EXPECT_LT(std::abs(out[1](30, 8)), 0.02f) << d.report().frame;
    }
  });
}

TEST(EigenDenoiser, BlackStaysBlack) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 5};
  options.gain = [](int) { return 0.0f; };
  run(options, {}, [&](const Planes<3>& out, const EigenDenoiser&, const AnalyticSource&) {
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 65; ++x) ASSERT_EQ(out[0](x, y), 0.0f);
    }
  });
}

TEST(EigenDenoiser, OutputScalesWithItsInput) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 8};
  options.slide = {0.6f, 0.2f};
  const auto last = [&](float scale) {
    options.gain = [scale](int frame) { return frame < 5 ? scale : 1.5f * scale; };
    Planes<3> picture = make_planes<3>(options.extent);
    run(options, {}, [&](const auto& out, const auto&, const auto&) { copy_planes(out, picture); });
    return picture;
  };
  const Planes<3> unit = last(1.0f);
  for (const float scale : {1e-6f, 1e6f}) {
    Planes<3> scaled = last(scale);
    for (auto& plane : scaled) {
      for (float& value : plane.storage()) value /= scale;
    }
    EXPECT_TRUE(planes_near(scaled, unit, {1e-4, 0.0})) << scale;
  }
}

TEST(EigenDenoiser, SkyIsZeroWhereASurfaceWas) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 6};
  options.edit = [](Frame& frame) {
    frame.is_static = false;
    const int edge = frame.index >= 3 ? 50 : 5;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < edge; ++x) {
        frame.surface.id(x, y) = 0;
        frame.surface.depth(x, y) = frame.previous_depth(x, y) = kInf;
        for (std::size_t c = 0; c < 3; ++c) {
          frame.surface.normal[c](x, y) = frame.lights[0].radiance[c](x, y) = 0.0f;
        }
      }
    }
  };
  run(options, {}, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    const int edge = d.report().frame >= 3 ? 50 : 5;
    EXPECT_EQ(d.report().surface_pixels, (96 - edge) * 64);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < edge; ++x) {
        ASSERT_EQ(out[1](x, y), 0.0f) << x << ", " << y << " frame " << d.report().frame;
        ASSERT_EQ(d.age()(x, y), 0.0f) << x << ", " << y << " frame " << d.report().frame;
      }
      ASSERT_GT(out[1](edge, y), 0.0f);
    }
  });
}

}  // namespace
}  // namespace eigenlight
