#include "temporal/eigen/eigen_denoiser.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "frame/float_traps.h"
#include "tests/support/analytic_source.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/extents.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// The temporal part alone: no resampling, no pixel is young, and every tile is quiet enough for no
// spatial pass.
EigenOptions temporal_only() {
  EigenOptions parts;
  parts.budget.share = 0.0;
  parts.young_age = 0.0f;
  parts.quiet_variance = 1.0f;
  return parts;
}

EigenOptions without_resampling() {
  EigenOptions parts;
  parts.budget.share = 0.0;
  return parts;
}

using Visit = std::function<void(const Planes<3>&, const EigenDenoiser&, const AnalyticSource&)>;

void run(const AnalyticOptions& options, const EigenOptions& parts, const Visit& visit) {
  AnalyticSource source(options);
  EigenDenoiser denoiser({options.extent, 3}, parts);
  while (const Planes<3>* out = denoiser.step(source)) visit(*out, denoiser, source);
}

// Mean of out / truth - 1 over all pixels with a surface.
double relative_bias(const Planes<3>& out, const AnalyticSource& source, const Frame& frame) {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (frame.surface.id(x, y) == 0) continue;
      sum += static_cast<double>(out[1](x, y) / source.truth({x, y}, 1, frame.index)) - 1.0;
      count += 1.0;
    }
  }
  return sum / count;
}

double mean_age(const EigenDenoiser& denoiser) {
  double sum = 0.0;
  const Plane<float>& age = denoiser.age();
  for (int y = 0; y < age.height(); ++y) {
    for (int x = 0; x < age.width(); ++x) sum += static_cast<double>(age(x, y));
  }
  return sum / static_cast<double>(age.extent().pixels());
}

TEST(EigenDenoiser, ErrorFallsAsOneOverTheNumberOfFramesUntilAgesSaturate) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 100};
  EigenOptions parts = temporal_only();
  parts.innovation.max_age = 32.0f;
  std::vector<double> error;
  run(options, parts, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource& s) {
    error.push_back(relative_error(out, s, d.frame()));
  });
  // One frame of 3 samples: 0.25 / 3.
  EXPECT_NEAR(error[0], 0.25 / 3.0, 0.004);
  // Chance shortens some memories (the innovation test at its threshold), hence up to 1.6.
  for (const std::size_t n : {2u, 4u, 8u, 16u}) {
    EXPECT_GT(error[n - 1] * static_cast<double>(n), 0.9 * error[0]) << n;
    EXPECT_LT(error[n - 1] * static_cast<double>(n), 1.6 * error[0]) << n;
  }
  // An exponential mean of weight 1/32 holds the noise of 63 frames.
  EXPECT_GT(error[99] * 63.0, 0.9 * error[0]);
  EXPECT_LT(error[99] * 63.0, 2.5 * error[0]);
}

// Noise alone, from two runs that differ in nothing else: what filters blur they blur in both.
double noise_of_last_frame(AnalyticOptions options, const EigenOptions& parts) {
  std::array<Planes<3>, 2> last{make_planes<3>(options.extent), make_planes<3>(options.extent)};
  for (auto& picture : last) {
    ++options.seed;
    run(options, parts,
        [&](const auto& out, const auto&, const auto&) { copy_planes(out, picture); });
  }
  double sum = 0.0;
  for (int y = 0; y < options.extent.height; ++y) {
    for (int x = 0; x < options.extent.width; ++x) {
      const double difference = last[0][1](x, y) - last[1][1](x, y);
      sum += 0.5 * difference * difference;
    }
  }
  return sum / static_cast<double>(options.extent.pixels());
}

TEST(EigenDenoiser, FilteringLowersTheNoiseFurther) {
  for (const int frames : {1, 6, 20}) {
    const AnalyticOptions options{.extent = {96, 64}, .frames = frames};
    EXPECT_LT(noise_of_last_frame(options, without_resampling()),
              0.25 * noise_of_last_frame(options, temporal_only()))
        << frames;
  }
}

// Dark lines, two pixels wide, on a wall: their own noise says little of them.
TEST(EigenDenoiser, LookingBackKeepsFineLight) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 16, .pattern = 0.0f};
  options.slide = {0.4f, 0.2f};
  options.light = [](glm::vec2 at, int) {
    return at.x - 12.0f * std::floor(at.x / 12.0f) < 2.0f ? 0.4f : 1.0f;
  };
  const auto error = [&](bool look_back) {
    EigenOptions parts = without_resampling();
    if (!look_back) {
      parts.look_back = false;
      parts.atrous.luminance_sigmas = 5.0f;  // the best value without
    }
    double last = 0.0;
    run(options, parts, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource& s) {
      last = relative_error(out, s, d.frame());
    });
    return last;
  };
  EXPECT_LT(error(true), 0.9 * error(false)) << error(true) << " against " << error(false);
}

TEST(EigenDenoiser, SkipsTheWarpOfStillFramesAndLosesNothing) {
  AnalyticOptions still{.extent = {65, 17}, .frames = 6};
  AnalyticOptions unknown = still;
  unknown.edit = [](Frame& frame) { frame.is_static = false; };
  std::vector<Planes<3>> skipped;
  run(still, {}, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    skipped.push_back({out[0].clone(), out[1].clone(), out[2].clone()});
    EXPECT_EQ(d.report().skipped_warp, d.report().cut ? 0 : 65 * 17);
  });
  std::size_t n = 0;
  run(unknown, {}, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    EXPECT_EQ(d.report().skipped_warp, 0);
    EXPECT_TRUE(planes_near(out, skipped[n++], {1e-5, 0.0}));
  });
}

// The source's wall is a plane: no tap of its filter needs to look at geometry.
TEST(EigenDenoiser, WeighsNoGeometryInPlanesAndLosesNothing) {
  const AnalyticOptions options{.extent = {65, 17}, .frames = 4};
  EigenOptions parts = without_resampling();
  std::vector<Planes<3>> skipped;
  run(options, parts, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    skipped.push_back({out[0].clone(), out[1].clone(), out[2].clone()});
    EXPECT_EQ(d.report().skipped_geometry, 65 * 17);
  });
  parts.atrous.skip_planar = parts.correction.skip_planar = false;
  std::size_t n = 0;
  run(options, parts, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    EXPECT_EQ(d.report().skipped_geometry, 0);
    EXPECT_TRUE(planes_near(out, skipped[n++], {1e-4, 0.0}));
  });
  EXPECT_EQ(n, 4u);
}

TEST(EigenDenoiser, FollowsASlidingCameraAndKeepsItsHistory) {
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

TEST(EigenDenoiser, FollowsStepsOfLightWithinTwoFrames) {
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

TEST(EigenDenoiser, FollowsLightThatGoesOffAndOn) {
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

TEST(EigenDenoiser, UsesTheSamplesItAsksFor) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 1};
  EigenOptions parts = temporal_only();
  const auto error = [&] {
    double value = 0.0;
    run(options, parts, [&](const auto& out, const auto& d, const auto& s) {
      value = relative_error(out, s, d.frame());
      EXPECT_EQ(d.report().extra_samples, static_cast<std::int64_t>(parts.budget.share * 18432.0));
      EXPECT_EQ(d.report().rays, 18432 + d.report().extra_samples);
      EXPECT_EQ(d.age()(10, 10), 1.0f + static_cast<float>(parts.budget.share));
    });
    return value;
  };
  const double plain = error();
  parts.budget.share = 3.0;
  EXPECT_NEAR(error() / plain, 0.25, 0.02);
}

TEST(EigenDenoiser, SkyIsZeroAlsoWhereASurfaceWas) {
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

TEST(EigenDenoiser, DoesWhatEveryMethodDoes) {
  expect_resumes("eigenlight");
  expect_forgets_at_cuts("eigenlight");
  expect_runs_at_any_size("eigenlight");
}

// The wide one falls into strips of other widths for other numbers of threads.
TEST(EigenDenoiser, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const Extent extent : {Extent{191, 107}, Extent{1400, 70}}) {
    AnalyticOptions options{.extent = extent, .frames = 4};
    options.slide = {0.7f, 0.3f};
    set_thread_count(1);
    const Planes<3> one = last_picture("eigenlight", options);
    for (const int threads : {3, 64}) {
      set_thread_count(threads);
      EXPECT_TRUE(planes_equal(last_picture("eigenlight", options), one)) << threads;
    }
    set_thread_count(0);
  }
}

TEST(EigenDenoiser, TargetsAgree) {
  AnalyticOptions options{.extent = {65, 17}, .frames = 6};
  options.slide = {0.7f, 0.3f};
  const Planes<3> best = last_picture("eigenlight", options);
  for_each_target([&] {
    // Sums in another order, a few ulp each, over six frames that feed on each other.
    EXPECT_TRUE(planes_near(last_picture("eigenlight", options), best, {1e-5, 0.0}));
  });
}

TEST(EigenDenoiser, RefusesBadOptions) {
  const FloatTrapsOff nan_is_meant;
  const auto refused = [](const std::function<void(EigenOptions&)>& change) {
    EigenOptions parts;
    change(parts);
    EXPECT_THROW(EigenDenoiser({{8, 8}, 3}, parts), std::invalid_argument);
  };
  refused([](EigenOptions& parts) { parts.quiet_variance = -1.0f; });
  refused([](EigenOptions& parts) { parts.quiet_variance = kNan; });
  refused([](EigenOptions& parts) { parts.birth_share = 2.0; });
  refused([](EigenOptions& parts) { parts.young_age = -1.0f; });
  refused([](EigenOptions& parts) { parts.max_age_changing = 0.0f; });
  refused([](EigenOptions& parts) { parts.max_age_changing = kNan; });
  refused([](EigenOptions& parts) { parts.taps.plane_distance = 0.0f; });
  refused([](EigenOptions& parts) { parts.innovation.max_age = 0.0f; });
  EXPECT_THROW(EigenDenoiser({{8, 8}, 0}), std::invalid_argument);
  EXPECT_THROW(EigenDenoiser({{0, 8}, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
