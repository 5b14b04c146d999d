// The denoiser of frames with noisy guides.
#include "temporal/eigen/soft_denoiser.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/analytic_source.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

// Heavy noise under light that pulses.
AnalyticOptions pulsing(int frames) {
  AnalyticOptions options{.extent = {96, 64}, .frames = frames, .noise = 1.0f};
  options.noise_kind = NoiseKind::kExponential;
  options.gain = [](int frame) { return 1.0f + 0.3f * std::sin(0.7f * static_cast<float>(frame)); };
  return options;
}

TEST(SoftDenoiser, KeepsTheLightOfHeavyNoise) {
  double bias = 0.0;
  int frames = 0;
  AnalyticSource source(pulsing(16));
  SoftDenoiser denoiser({.extent = {96, 64}});
  while (const Planes<3>* out = denoiser.step(source)) {
    bias += relative_bias(*out, source, denoiser.frame());
    ++frames;
  }
  EXPECT_EQ(frames, 16);
  EXPECT_NEAR(bias / frames, 0.0, 0.02);
}

TEST(SoftDenoiser, RemovesNoise) {
  AnalyticSource source(pulsing(12));
  SoftDenoiser denoiser({.extent = {96, 64}});
  double error = 1.0;
  while (const Planes<3>* out = denoiser.step(source)) {
    error = relative_error(*out, source, denoiser.frame());
  }
  // One frame has a relative error of 1.
  EXPECT_LT(error, 1.0 / 50.0);
}

TEST(SoftDenoiser, StateContinuesWithTheSameBits) {
  AnalyticSource source(pulsing(8)), again(pulsing(8));
  SoftDenoiser first({.extent = {96, 64}}), whole({.extent = {96, 64}});
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(first.step(source));
    ASSERT_TRUE(whole.step(again));
  }
  StateWriter writer;
  first.save(writer);
  SoftDenoiser second({.extent = {96, 64}});
  StateReader reader({writer.bytes().data(), writer.bytes().size()});
  second.load(reader);
  for (int i = 0; i < 4; ++i) {
    const Planes<3>* resumed = second.step(source);
    const Planes<3>* steady = whole.step(again);
    ASSERT_TRUE(resumed && steady);
    EXPECT_TRUE(planes_equal(*resumed, *steady)) << i;
  }
}

}  // namespace
}  // namespace eigenlight
