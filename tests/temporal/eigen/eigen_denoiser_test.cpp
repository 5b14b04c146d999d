// Noise, skipped work and repeatability of the denoiser.
#include "temporal/eigen/eigen_denoiser.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "frame/float_traps.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/targets.h"
#include "tests/temporal/eigen/eigen_runs.h"

namespace eigenlight {
namespace {

using test::run;
using test::temporal_only;
using test::without_resampling;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(EigenDenoiser, ErrorFallsWithTheNumberOfFrames) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 100};
  EigenOptions settings = temporal_only();
  settings.innovation.max_age = 32.0f;
  std::vector<double> error;
  run(options, settings,
      [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource& s) {
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

// The noise alone, as the difference of two runs with other noise: blur is the same in both.
double noise_of_last_frame(AnalyticOptions options, const EigenOptions& settings) {
  std::array<Planes<3>, 2> last{make_planes<3>(options.extent), make_planes<3>(options.extent)};
  for (auto& picture : last) {
    ++options.seed;
    run(options, settings,
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

TEST(EigenDenoiser, SpatialFilterLowersTheNoise) {
  for (const int frames : {1, 6, 20}) {
    const AnalyticOptions options{.extent = {96, 64}, .frames = frames};
    EXPECT_LT(noise_of_last_frame(options, without_resampling()),
              0.25 * noise_of_last_frame(options, temporal_only()))
        << frames;
  }
}

// Dark lines, two pixels wide, on a wall. Their contrast is low compared to their noise.
TEST(EigenDenoiser, EarlierPictureKeepsFineLight) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 16, .pattern = 0.0f};
  options.slide = {0.4f, 0.2f};
  options.light = [](glm::vec2 at, int) {
    return at.x - 12.0f * std::floor(at.x / 12.0f) < 2.0f ? 0.4f : 1.0f;
  };
  const auto error = [&](bool look_back) {
    EigenOptions settings = without_resampling();
    if (!look_back) {
      settings.look_back = false;
      settings.atrous.luminance_sigmas = 5.0f;  // the best value without
    }
    double last = 0.0;
    run(options, settings,
        [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource& s) {
          last = relative_error(out, s, d.frame());
        });
    return last;
  };
  EXPECT_LT(error(true), 0.9 * error(false)) << error(true) << " against " << error(false);
}

TEST(EigenDenoiser, SkippingTheWarpOfStillFramesChangesNothing) {
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
TEST(EigenDenoiser, SkippingGeometryInPlanesChangesNothing) {
  const AnalyticOptions options{.extent = {65, 17}, .frames = 4};
  EigenOptions settings = without_resampling();
  std::vector<Planes<3>> skipped;
  run(options, settings, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    skipped.push_back({out[0].clone(), out[1].clone(), out[2].clone()});
    EXPECT_EQ(d.report().skipped_geometry, 65 * 17);
  });
  settings.atrous.skip_planar = settings.correction.skip_planar = false;
  std::size_t n = 0;
  run(options, settings, [&](const Planes<3>& out, const EigenDenoiser& d, const AnalyticSource&) {
    EXPECT_EQ(d.report().skipped_geometry, 0);
    EXPECT_TRUE(planes_near(out, skipped[n++], {1e-4, 0.0}));
  });
  EXPECT_EQ(n, 4u);
}

TEST(EigenDenoiser, ExtraSamplesLowerTheError) {
  AnalyticOptions options{.extent = {96, 64}, .frames = 1};
  EigenOptions settings = temporal_only();
  const auto error = [&] {
    double value = 0.0;
    run(options, settings, [&](const auto& out, const auto& d, const auto& s) {
      value = relative_error(out, s, d.frame());
      EXPECT_EQ(d.report().extra_samples,
                static_cast<std::int64_t>(settings.budget.share * 18432.0));
      EXPECT_EQ(d.report().rays, 18432 + d.report().extra_samples);
      EXPECT_EQ(d.age()(10, 10), 1.0f + static_cast<float>(settings.budget.share));
    });
    return value;
  };
  const double plain = error();
  settings.budget.share = 3.0;
  EXPECT_NEAR(error() / plain, 0.25, 0.02);
}

TEST(EigenDenoiser, PassesTheChecksOfEveryMethod) {
  expect_resumes("eigenlight");
  expect_forgets_at_cuts("eigenlight");
  expect_keeps_constant_light("eigenlight", 1e-5f);
  expect_runs_at_any_size("eigenlight");
}

// The wide one falls into strips of other widths for other numbers of threads.
TEST(EigenDenoiser, ThreadCountDoesNotChangeTheBits) {
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

TEST(EigenDenoiser, RejectsBadOptions) {
  const FloatTrapsOff nan_is_meant;
  const auto refused = [](const std::function<void(EigenOptions&)>& change) {
    EigenOptions settings;
    change(settings);
    EXPECT_THROW(EigenDenoiser({{8, 8}, 3}, settings), std::invalid_argument);
  };
  refused([](EigenOptions& settings) { settings.quiet_variance = -1.0f; });
  refused([](EigenOptions& settings) { settings.quiet_variance = kNan; });
  refused([](EigenOptions& settings) { settings.birth_share = 2.0; });
  refused([](EigenOptions& settings) { settings.young_age = -1.0f; });
  refused([](EigenOptions& settings) { settings.max_age_changing = 0.0f; });
  refused([](EigenOptions& settings) { settings.max_age_changing = kNan; });
  refused([](EigenOptions& settings) { settings.taps.plane_distance = 0.0f; });
  refused([](EigenOptions& settings) { settings.innovation.max_age = 0.0f; });
  EXPECT_THROW(EigenDenoiser({{8, 8}, 0}), std::invalid_argument);
  EXPECT_THROW(EigenDenoiser({{0, 8}, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
