// Work that the denoiser skips: the picture must be the same, or nearly so, without the skip.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "temporal/eigen/eigen_denoiser.h"
#include "tests/support/analytic_source.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

struct SkipRun {
  std::vector<Planes<3>> pictures;
  FrameReport last;
  double error = 0.0;  // of the last picture, relative to the truth
};

SkipRun denoise(const AnalyticOptions& options, const EigenOptions& parts) {
  SkipRun run;
  AnalyticSource source(options);
  EigenDenoiser denoiser({options.extent, 3}, parts);
  while (const Planes<3>* out = denoiser.step(source)) {
    run.pictures.push_back({(*out)[0].clone(), (*out)[1].clone(), (*out)[2].clone()});
    run.last = denoiser.report();
    run.error = relative_error(*out, source, denoiser.frame());
  }
  return run;
}

// Static camera, pulsing light, sky in the left third.
AnalyticOptions scene() {
  AnalyticOptions options{.extent = {96, 64}, .frames = 12};
  options.sky_columns = 40;
  options.gain = [](int frame) { return 1.0f + 0.3f * std::sin(0.7f * static_cast<float>(frame)); };
  return options;
}

void expect_equal(const SkipRun& a, const SkipRun& b) {
  ASSERT_EQ(a.pictures.size(), b.pictures.size());
  for (std::size_t i = 0; i < a.pictures.size(); ++i) {
    EXPECT_TRUE(planes_equal(a.pictures[i], b.pictures[i])) << "frame " << i;
  }
}

// Mean of (a / b - 1)^2 over the last pictures where b > 0.
double mean_square_change(const SkipRun& a, const SkipRun& b) {
  double sum = 0.0, count = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const Plane<float>&x = a.pictures.back()[c], &y = b.pictures.back()[c];
    for (int j = 0; j < x.height(); ++j) {
      for (int i = 0; i < x.width(); ++i) {
        if (!(y(i, j) > 0.0f)) continue;
        sum += std::pow(static_cast<double>(x(i, j)) / static_cast<double>(y(i, j)) - 1.0, 2.0);
        count += 1.0;
      }
    }
  }
  return sum / count;
}

TEST(Skips, StaticFramesNeedNoWarp) {
  EigenOptions all;
  all.skip_still = false;
  const SkipRun skipped = denoise(scene(), {}), full = denoise(scene(), all);
  EXPECT_EQ(skipped.last.skipped_warp, 96 * 64);
  EXPECT_EQ(full.last.skipped_warp, 0);
  expect_equal(skipped, full);
}

TEST(Skips, TilesWithoutSurfaceNeedNoWork) {
  EigenOptions all;
  all.skip_empty = false;
  const SkipRun skipped = denoise(scene(), {}), full = denoise(scene(), all);
  EXPECT_GT(skipped.last.skipped_surface, 0);
  EXPECT_EQ(full.last.skipped_surface, 0);
  expect_equal(skipped, full);
}

// Weights are 1 up to rounding where all taps lie in one plane.
TEST(Skips, PlanesNeedNoWeightsOfGeometry) {
  EigenOptions all;
  all.atrous.skip_planar = all.correction.skip_planar = false;
  const SkipRun skipped = denoise(scene(), {}), full = denoise(scene(), all);
  EXPECT_GT(skipped.last.skipped_geometry, 0);
  EXPECT_EQ(full.last.skipped_geometry, 0);
  EXPECT_LT(mean_square_change(skipped, full), 1e-9);
}

// A tile is quiet if its variance is below 1e-5 of the squared luminance. The filter would mix
// light that is up to 7 deviations off: 49 times 1e-5 of the square, at a filter's reach of several
// pixels somewhat more.
TEST(Skips, QuietTilesNeedNoFilter) {
  AnalyticOptions options = scene();
  options.gain = [](int) { return 1.0f; };
  options.noise = 0.005f;
  options.frames = 60;  // the variance that a pixel starts with, that of its neighborhood, has gone
  EigenOptions all;
  all.quiet_variance = 0.0f;
  const SkipRun skipped = denoise(options, {}), full = denoise(options, all);
  EXPECT_GT(skipped.last.skipped_filter, full.last.skipped_filter);
  EXPECT_LT(mean_square_change(skipped, full), 2.0 * 49e-5);
}

TEST(Skips, SteadyLightNeedsNoCorrection) {
  AnalyticOptions options = scene();
  options.gain = [](int) { return 1.0f; };
  EigenOptions all;
  all.correction.gated = false;
  const SkipRun skipped = denoise(options, {}), full = denoise(options, all);
  EXPECT_EQ(skipped.last.skipped_correction, 96 * 64);
  EXPECT_EQ(full.last.skipped_correction, 0);
  EXPECT_NEAR(skipped.error / full.error, 1.0, 0.05);
}

}  // namespace
}  // namespace eigenlight
