#include "temporal/gather/window_denoiser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/compare.h"
#include "tests/temporal/gather/window_runs.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// One sample a pixel, whose light is exponential, under light that pulses; a camera that slides.
AnalyticOptions pulsing(int frames) {
  AnalyticOptions options{.extent = {96, 64}, .frames = frames, .spp = 1, .noise = 1.0f};
  options.slide = {0.7f, 0.3f};
  options.noise_kind = NoiseKind::kExponential;
  options.gain = [](int frame) { return 1.0f + 0.3f * std::sin(0.7f * static_cast<float>(frame)); };
  return options;
}

// Light of a picture over the true one.
double energy(const Planes<3>& picture, const AnalyticSource& source, int frame) {
  double sum = 0.0, truth = 0.0;
  for (int y = 0; y < picture[0].height(); ++y) {
    for (int x = 0; x < picture[0].width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        sum += static_cast<double>(picture[c](x, y));
        truth += static_cast<double>(source.truth({x, y}, c, frame));
      }
    }
  }
  return sum / truth;
}

struct Quality {
  double energy = 0.0, error = 0.0;
};

// Means over all frames.
Quality quality(const AnalyticOptions& options, int ahead) {
  const std::vector<Frame> frames = frames_of(options);
  const std::vector<Planes<3>> outputs = run_window(frames, window(ahead));
  const AnalyticSource source(options);
  Quality mean;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    mean.energy += energy(outputs[i], source, frames[i].index);
    mean.error += relative_error(outputs[i], source, frames[i]);
  }
  const auto count = static_cast<double>(outputs.size());
  return {mean.energy / count, mean.error / count};
}

TEST(WindowDenoiser, KeepsTheLightOfHeavyNoise) {
  for (const int ahead : {0, 4}) {
    EXPECT_NEAR(quality(pulsing(16), ahead).energy, 1.0, 0.01) << ahead;
  }
}

// Where light is smooth, all that is left is noise.
TEST(WindowDenoiser, LaterFramesLowerTheError) {
  AnalyticOptions options = pulsing(12);
  options.pattern = 0.0f;
  const double alone = quality(options, 0).error, helped = quality(options, 4).error;
  // One frame has a relative error of 1.
  EXPECT_LT(alone, 1.0 / 800.0);
  // What even_light() measures in one frame is most of what is left.
  EXPECT_LT(helped, 0.9 * alone);
}

TEST(WindowDenoiser, EachFrameComesOutOnceAndInOrder) {
  const std::vector<Frame> frames = frames_of(pulsing(6));
  WindowDenoiser denoiser({96, 64}, 1, window(2));
  EXPECT_FALSE(denoiser.step());
  int out = 0;
  for (int pushed = 0; pushed < 6; ++pushed) {
    push_copy(frames[static_cast<std::size_t>(pushed)], denoiser);
    const bool is_ready = denoiser.step();
    EXPECT_EQ(is_ready, pushed >= 2);
    if (is_ready) {
      EXPECT_EQ(denoiser.report().frame, out++);
    }
    EXPECT_FALSE(denoiser.step());
  }
  denoiser.finish();
  for (; denoiser.step(); ++out) EXPECT_EQ(denoiser.report().frame, out);
  EXPECT_EQ(out, 6);
  // A shot shorter than what is looked ahead.
  EXPECT_EQ(run_window(frames_of(pulsing(2)), window(8)).size(), 2u);
  EXPECT_EQ(run_window(frames_of(pulsing(1)), window(8, 0)).size(), 1u);
}

TEST(WindowDenoiser, FramesBeyondTheWindowChangeNothing) {
  const std::vector<Frame> frames = frames_of(pulsing(9));
  AnalyticOptions others = pulsing(9);
  others.seed = 7;
  others.light = [](glm::vec2, int frame) { return frame < 6 ? 1.0f : 20.0f; };
  std::vector<Frame> mixed = frames_of(others);
  for (std::size_t i = 0; i < 6; ++i) copy_frame(frames[i], mixed[i]);
  const auto one = run_window(frames, window(2)), two = run_window(mixed, window(2));
  ASSERT_EQ(one.size(), 9u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(planes_equal(two[i], one[i])) << i;
  for (std::size_t i = 4; i < 9; ++i) EXPECT_FALSE(planes_equal(two[i], one[i])) << i;
}

TEST(WindowDenoiser, WaitingChangesNothing) {
  const std::vector<Frame> frames = frames_of(pulsing(9));
  for (const int ahead : {0, 3}) {
    const auto soon = run_window(frames, window(ahead)),
               late = run_window(frames, window(ahead), true);
    ASSERT_EQ(soon.size(), 9u);
    ASSERT_EQ(late.size(), 9u);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_TRUE(planes_equal(late[i], soon[i])) << i;
  }
}

TEST(WindowDenoiser, SameBitsOnAnyNumberOfThreads) {
  const std::vector<Frame> frames = frames_of(pulsing(5));
  set_thread_count(1);
  const auto one = run_window(frames, window(2));
  set_thread_count(2);
  const auto two = run_window(frames, window(2));
  set_thread_count(0);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(planes_equal(two[i], one[i])) << i;
}

// Both sides of a cut are as if the other one was not there.
void expect_cut(bool is_direct) {
  AnalyticOptions options = pulsing(10);
  options.light = [](glm::vec2, int frame) { return frame < 5 ? 1.0f : 30.0f; };
  options.edit = [&](Frame& frame) {
    frame.lights[0].is_direct = is_direct;
    if (frame.index == 5) frame.previous_index = -1;
  };
  const std::vector<Frame> frames = frames_of(options);
  AnalyticOptions head = options, tail = options;
  head.frames = 5;
  tail.first_frame = 5, tail.frames = 5;
  const auto whole = run_window(frames, window(4));
  const auto before = run_window(frames_of(head), window(4));
  const auto after = run_window(frames_of(tail), window(4));
  ASSERT_EQ(whole.size(), 10u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(planes_equal(whole[i], before[i])) << i;
    EXPECT_TRUE(planes_equal(whole[5 + i], after[i])) << i;
  }
}

TEST(WindowDenoiser, NoLightCrossesACut) {
  expect_cut(false);
  expect_cut(true);
}

// A run that goes on needs the frames before, and nothing else.
void expect_resumes(bool is_direct, int ahead) {
  AnalyticOptions options = pulsing(12);
  options.edit = [&](Frame& frame) { frame.lights[0].is_direct = is_direct; };
  const std::vector<Frame> frames = frames_of(options);
  constexpr std::size_t kLast = 6;  // the last one that another run has written
  const std::vector<Planes<3>> whole = run_window(frames, window(ahead, 3));
  WindowDenoiser second({96, 64}, 1, window(ahead, 3));
  EXPECT_EQ(second.past(), 3);
  for (std::size_t i = kLast - 2; i <= kLast; ++i) second.push_past(frames[i]);
  EXPECT_FALSE(second.step());
  std::vector<Planes<3>> resumed;
  for (std::size_t i = kLast + 1; i < frames.size(); ++i) {
    push_copy(frames[i], second);
    take_outputs(second, resumed);
  }
  second.finish();
  take_outputs(second, resumed);
  ASSERT_EQ(whole.size(), 12u);
  ASSERT_EQ(resumed.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(planes_equal(resumed[i], whole[kLast + 1 + i])) << i;
  }
}

TEST(WindowDenoiser, GoesOnBehindPastFramesWithTheSameBits) {
  expect_resumes(false, 3);
  expect_resumes(true, 3);
  expect_resumes(true, 0);
}

// Colors that differ from frame to frame by the noise of a few samples, times light without noise.
TEST(WindowDenoiser, SteadiesColors) {
  AnalyticOptions options = pulsing(9);
  options.light = [](glm::vec2, int) { return 1.0f; };
  options.pattern = 0.0f;
  options.noise = 0.0f;
  constexpr float kColor = 0.4f;
  std::vector<Planes<3>> colors;
  options.edit = [&](Frame& frame) {
    Planes<3>& color = frame.lights[0].color;
    color = make_planes<3>(frame.extent());
    for (int c = 0; c < 3; ++c) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 96; ++x) {
          const float noise = to_unit(hash_key(3, x, y, 10 * frame.index + c)) - 0.5f;
          color[c](x, y) = kColor + 0.08f * noise;
        }
      }
    }
    colors.push_back(make_planes<3>(frame.extent()));
    copy_planes(color, colors.back());
  };
  const std::vector<Frame> frames = frames_of(options);
  const AnalyticSource source(options);
  const std::vector<Planes<3>> outputs = run_window(frames, window(4, 4));
  double before = 0.0, after = 0.0;
  for (int y = 8; y < 56; ++y) {
    for (int x = 8; x < 88; ++x) {
      const double truth = static_cast<double>(kColor * source.truth({x, y}, 0, 4));
      const auto own = static_cast<double>(colors[4][0](x, y));
      before += std::pow(own * static_cast<double>(source.truth({x, y}, 0, 4)) - truth, 2.0);
      after += std::pow(own * static_cast<double>(outputs[4][0](x, y)) - truth, 2.0);
    }
  }
  EXPECT_LT(after, 0.3 * before);
}

TEST(WindowDenoiser, RefusesPastFramesAmidWaitingOnes) {
  const std::vector<Frame> frames = frames_of(pulsing(2));
  WindowDenoiser denoiser({96, 64}, 1);
  push_copy(frames[0], denoiser);
  EXPECT_THAT(
      [&] { denoiser.push_past(frames[1]); },
      ThrowsMessage<std::invalid_argument>(HasSubstr("frame 1: frames to be denoised wait")));
}

TEST(WindowDenoiser, ChecksFramesAndOptions) {
  std::vector<Frame> frames = frames_of(pulsing(1));
  WindowDenoiser narrow({95, 64}, 1), two({96, 64}, 2);
  EXPECT_THAT([&] { push_copy(frames[0], narrow); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("frame 0: its size differs")));
  EXPECT_THAT([&] { push_copy(frames[0], two); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("1 layers of light, expected 2")));
  EXPECT_THAT([] { window(65).validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("ahead 65")));
  EXPECT_THAT([] { window(0, -1).validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("past -1")));
  WindowOptions options;
  options.direct.sigmas = 0.0f;
  EXPECT_THAT([&] { options.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("sigmas 0")));
}

}  // namespace
}  // namespace eigenlight
