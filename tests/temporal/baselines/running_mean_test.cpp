#include "temporal/baselines/running_mean.h"

#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

TEST(RunningMean, ErrorFallsWithTheNumberOfFrames) {
  AnalyticSource source({.frames = 80});
  RunningMean mean({{64, 36}, 3});
  for (int frame = 0; frame < 80; ++frame) {
    const Planes<3>* out = mean.step(source);
    ASSERT_NE(out, nullptr);
    // One sample has a relative variance of 0.25, a frame three of them. 64 x 36 x 3 values give
    // the mean of their squares to within 5 %.
    const double variance = 0.25 / 3.0;
    const double error = relative_error(*out, source, mean.frame());
    if (frame < 32) {
      EXPECT_NEAR(error * (frame + 1) / variance, 1.0, 0.07) << frame;
    }
    // The limit of mean += (u - mean) / n is an exponential mean of 2 n - 1 frames.
    if (frame > 70) {
      EXPECT_LT(error * 40 / variance, 1.0) << frame;
    }
    EXPECT_EQ(mean.age()(5, 5), static_cast<float>(std::min(frame + 1, 32)));
  }
  EXPECT_EQ(mean.step(source), nullptr);
}

TEST(RunningMean, FollowsSurfacesUnderAMovingCamera) {
  AnalyticOptions options{.frames = 20};
  options.slide = {1.4f, -1.3f};
  options.sky_columns = 6;
  AnalyticSource source(options);
  RunningMean mean({options.extent, 3});
  const Planes<3>* out = nullptr;
  for (int frame = 0; frame < 20; ++frame) out = mean.step(source);
  EXPECT_LT(relative_error(*out, source, mean.frame()), 0.35 * 0.25 / 3.0);
  // The slide uncovers the last column and the first row.
  EXPECT_EQ(mean.age()(63, 10), 1.0f);
  EXPECT_EQ(mean.age()(20, 0), 1.0f);
  EXPECT_GT(mean.age()(20, 33), 15.0f);
  EXPECT_EQ(mean.age()(2, 5), 0.0f);
  EXPECT_EQ((*out)[0](2, 5), 0.0f);
  EXPECT_EQ(mean.report().new_pixels, 58 + 36 - 1);
  EXPECT_EQ(mean.report().surface_pixels, 58 * 36);
}

TEST(RunningMean, KeepsConstantLight) { expect_keeps_constant_light("mean", 1e-6f); }

TEST(RunningMean, LeavesOutNonFiniteLight) {
  expect_leaves_out_non_finite_light(
      [](Extent extent) {
        return make_denoiser("mean", {extent, 3});
      },
      {.fills = false, .absolute = 1e-6});
}

TEST(RunningMean, ResumesWithTheSameBits) { expect_resumes("mean"); }
TEST(RunningMean, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("mean"); }
TEST(RunningMean, SkipsTheWarpOfStillFrames) {
  expect_still_frames_change_nothing("mean");
  AnalyticSource source({.frames = 2});
  RunningMean mean({{64, 36}, 3});
  ASSERT_NE(mean.step(source), nullptr);
  EXPECT_EQ(mean.report().skipped_warp, 0);
  ASSERT_NE(mean.step(source), nullptr);
  EXPECT_EQ(mean.report().skipped_warp, 64 * 36);
}
TEST(RunningMean, ThreadCountDoesNotChangeTheBits) {
  expect_same_bits_on_any_number_of_threads("mean");
}
TEST(RunningMean, RunsAtAnySize) { expect_runs_at_any_size("mean"); }

}  // namespace
}  // namespace eigenlight
