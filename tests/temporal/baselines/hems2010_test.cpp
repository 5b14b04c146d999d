#include "temporal/baselines/hems2010.h"

#include "frame/float_traps.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr HemsOptions kTimeOnly{.radius = 0, .color = 100.0f};

TEST(Hems2010, AveragesSeventeenFrames) {
  AnalyticOptions options{.frames = 24};
  AnalyticSource source(options);
  Hems2010 hems({options.extent, 1}, kTimeOnly);
  for (int frame = 0; frame < 24; ++frame) {
    const Planes<3>* out = hems.step(source);
    const double variance = 0.25 / 3.0;
    const int frames = std::min(frame + 1, 17);
    // 64 x 36 x 3 values give the mean of their squares to within 5 %.
    EXPECT_NEAR(relative_error(*out, source, hems.frame()) * frames / variance, 1.0, 0.07) << frame;
    EXPECT_NEAR(hems.age()(9, 9), static_cast<float>(frames), 0.1f);
  }
}

TEST(Hems2010, FollowsPointsThroughPastFrames) {
  // With a slide of half a pixel every other frame is read between two pixels. Each is resampled
  // once only, so light from 16 frames ago is at the right position.
  AnalyticOptions options{.frames = 20, .noise = 0.0f};
  options.slide = {1.5f, -0.5f};
  options.sky_columns = 6;
  AnalyticSource source(options);
  Hems2010 hems({options.extent, 1}, kTimeOnly);
  const Planes<3>* out = nullptr;
  for (int frame = 0; frame < 20; ++frame) out = hems.step(source);
  EXPECT_LT(relative_error(*out, source, hems.frame()), 1e-5);
  // The slide uncovers the last one or two columns and a row every other frame.
  EXPECT_EQ(hems.age()(63, 10), 1.0f);
  EXPECT_NEAR(hems.age()(36, 30), 17.0f, 0.05f);
  // A pixel 11 columns from the right edge has been visible in 7 frames before this one.
  EXPECT_NEAR(hems.age()(63 - 11, 30), 8.0f, 0.05f);
  EXPECT_EQ(hems.age()(2, 5), 0.0f);
  EXPECT_EQ((*out)[0](2, 5), 0.0f);
  EXPECT_EQ(hems.report().surface_pixels, 58 * 36);
}

TEST(Hems2010, ForgetsLightOfAnotherColor) {
  AnalyticOptions options{.frames = 12, .noise = 0.0f};
  options.gain = [](int frame) { return frame < 10 ? 1.0f : 3.0f; };
  AnalyticSource source(options);
  Hems2010 strict({options.extent, 1}, {.radius = 0, .color = 0.1f});
  const Planes<3>* out = nullptr;
  for (int frame = 0; frame < 11; ++frame) out = strict.step(source);
  // |3 - 1|^2 over 5 is 0.8: a weight of exp(-40).
  EXPECT_NEAR((*out)[1](20, 20), source.truth({20, 20}, 1, 10), 1e-4f);
  EXPECT_NEAR(strict.age()(20, 20), 1.0f, 1e-3f);

  AnalyticSource again(options);
  Hems2010 lax({options.extent, 1}, kTimeOnly);
  for (int frame = 0; frame < 11; ++frame) out = lax.step(again);
  // Ten frames of 1 and one of 3.
  EXPECT_NEAR((*out)[1](20, 20) / again.truth({20, 20}, 1, 0), 13.0f / 11.0f, 1e-3f);
}

TEST(Hems2010, SmoothsAlongSurfacesOnly) {
  AnalyticOptions options{.frames = 1};
  options.edit = [](Frame& frame) {
    // A step in depth and light at column 32.
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (x >= 32) frame.surface.depth(x, y) *= 2.0f;
        for (auto& plane : frame.lights[0].radiance) plane(x, y) = x < 32 ? 1.0f : 5.0f;
      }
    }
    frame.lights[0].radiance[0](10, 10) = 26.0f;
  };
  AnalyticSource source(options);
  Hems2010 hems({options.extent, 1}, {.radius = 2});
  const Planes<3>* out = hems.step(source);
  EXPECT_NEAR((*out)[0](31, 20), 1.0f, 1e-5f);
  EXPECT_NEAR((*out)[0](32, 20), 5.0f, 1e-5f);
  EXPECT_GT((*out)[0](11, 10), 2.0f);
  EXPECT_EQ((*out)[0](14, 10), 1.0f);
}

TEST(Hems2010, LeavesOutNonFiniteLight) {
  expect_leaves_out_non_finite_light(
      [](Extent extent) {
        return std::make_unique<Hems2010>(DenoiserOptions{extent, 1}, kTimeOnly);
      },
      {.fills = false});
}

TEST(HemsOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(Hems2010({{8, 8}, 1}, {.frames = 17}), std::invalid_argument);
  EXPECT_THROW(Hems2010({{8, 8}, 1}, {.radius = -1}), std::invalid_argument);
  EXPECT_THROW(Hems2010({{8, 8}, 1}, {.color = 0.0f}), std::invalid_argument);
  EXPECT_THROW(Hems2010({{8, 8}, 1}, {.color = kNan}), std::invalid_argument);
}

TEST(Hems2010, KeepsConstantLight) { expect_keeps_constant_light("hems2010", 1e-5f); }

TEST(Hems2010, ResumesWithTheSameBits) { expect_resumes("hems2010"); }
TEST(Hems2010, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("hems2010"); }
TEST(Hems2010, SkippingStillFramesChangesNothing) {
  expect_still_frames_change_nothing("hems2010");
}
TEST(Hems2010, ThreadCountDoesNotChangeTheBits) {
  expect_same_bits_on_any_number_of_threads("hems2010");
}
TEST(Hems2010, RunsAtAnySize) { expect_runs_at_any_size("hems2010"); }

}  // namespace
}  // namespace eigenlight
