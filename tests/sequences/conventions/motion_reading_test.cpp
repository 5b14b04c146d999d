#include "sequences/conventions/motion_reading.h"

#include <gmock/gmock.h>

#include <random>
#include <string>
#include <vector>

#include "tests/sequences/conventions/analytic_shot.h"

namespace eigenlight {
namespace {

using ::testing::HasSubstr;

// Two channels as a renderer with that reading writes them. A reading of the second pair gets
// noise in the first.
void encode(RawGuides& guides, const MotionReading& reading) {
  const std::size_t from = reading.backward ? 0 : 2;
  std::vector<Plane<float>> channels;
  channels.push_back(std::move(guides.motion[from]));
  channels.push_back(std::move(guides.motion[from + 1]));
  scale(channels[0], 1.0 / reading.scale_x);
  scale(channels[1], 1.0 / reading.scale_y);
  if (reading.pair == 1) {
    std::mt19937 random(5);
    std::normal_distribution<float> noise(0.0f, 3.0f);
    for (int c = 0; c < 2; ++c) {
      Plane<float> plane(guides.depth.extent());
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) plane(x, y) = noise(random);
      }
      channels.insert(channels.begin(), std::move(plane));
    }
  }
  guides.motion = std::move(channels);
}

std::vector<RawGuides> shot_of(const AnalyticShot& shot, const MotionReading& reading, bool noisy) {
  std::vector<RawGuides> frames;
  for (int frame = 3; frame < 5; ++frame) {
    frames.push_back(shot.frame(frame));
    encode(frames.back(), reading);
    if (noisy) spoil(frames.back(), static_cast<unsigned>(frame));
  }
  return frames;
}

MotionReading reading_of(const char* text, const AnalyticShot& shot) {
  return *parse_motion(text, shot.extent);
}

class EveryReading : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryReading, IsFoundInNoise) {
  const AnalyticShot shot;
  const MotionReading truth = reading_of(GetParam(), shot);
  const MotionFit fit = find_motion(shot_of(shot, truth, true));
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_EQ(format_motion(fit.best, shot.extent), format_motion(truth, shot.extent)) << fit.words;
  EXPECT_GT(fit.next_residual, kClearRatio * fit.residual) << fit.words;
}

INSTANTIATE_TEST_SUITE_P(All, EveryReading,
                         ::testing::Values("x,y,pixels,backward", "x,-y,pixels,backward",
                                           "-x,y,pixels,backward", "-x,-y,pixels,backward",
                                           "x,y,uv,backward", "-x,-y,uv,backward",
                                           "x,-y,ndc,backward", "-x,y,ndc,backward",
                                           "x,y,pixels,forward", "-x,y,pixels,forward",
                                           "-x,-y,uv,forward", "-x,y,ndc,forward",
                                           "x,-y,pixels,backward,second", "-x,y,uv,forward,second"),
                         [](const auto& named) {
                           std::string name = named.param;
                           for (char& c : name) {
                             if (c == ',') c = '_';
                             if (c == '-') c = 'm';
                           }
                           return name;
                         });

TEST(MotionReading, FindsTheScaleOfAShortShutter) {
  const AnalyticShot shot;
  const MotionReading truth = reading_of("-x,y,3.2,backward", shot);
  const MotionFit fit = find_motion(shot_of(shot, truth, true));
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_NEAR(fit.best.scale_x, -3.2, 0.1) << fit.words;
  EXPECT_NEAR(fit.best.scale_y, 3.2, 0.1) << fit.words;
}

TEST(MotionReading, FindsAHalfShutterThoughPixelsLeadHalfway) {
  const AnalyticShot shot;
  const MotionReading truth = reading_of("x,-y,2,backward", shot);
  const MotionFit fit = find_motion(shot_of(shot, truth, true));
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_NEAR(fit.best.scale_x, 2.0, 0.08) << fit.words;
}

TEST(MotionReading, IsFoundWithoutDepthOrWithoutColors) {
  const AnalyticShot shot;
  const MotionReading truth = reading_of("x,-y,pixels,backward", shot);
  std::vector<RawGuides> frames = shot_of(shot, truth, true);
  for (RawGuides& frame : frames) frame.depth = {};
  EXPECT_EQ(find_motion(frames).best, truth);
  frames = shot_of(shot, truth, true);
  for (RawGuides& frame : frames) {
    frame.albedo = {};
    frame.normal = {};
  }
  const MotionFit fit = find_motion(frames);
  EXPECT_EQ(fit.best, truth) << fit.words;
}

TEST(MotionReading, RefusesWhereNothingMoves) {
  AnalyticShot shot;
  shot.pace = 0.0f;
  const MotionFit fit = find_motion(shot_of(shot, reading_of("x,y", shot), true));
  EXPECT_FALSE(fit.is_clear);
  EXPECT_THAT(fit.words, HasSubstr("nothing moves"));
  EXPECT_THAT(fit.words, HasSubstr("--motion"));
}

TEST(MotionReading, RefusesASignThatTheFramesDoNotTell) {
  AnalyticShot shot;
  shot.only_vertical = true;
  const MotionFit fit = find_motion(shot_of(shot, reading_of("x,-y", shot), false));
  EXPECT_FALSE(fit.is_clear);
  EXPECT_THAT(fit.words, HasSubstr("do not tell"));
  EXPECT_LT(fit.best.scale_y, 0.0);
}

TEST(MotionReading, RefusesVectorsThatMeanNothing) {
  const AnalyticShot shot;
  std::vector<RawGuides> frames = shot_of(shot, reading_of("x,y", shot), true);
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0.0f, 4.0f);
  for (RawGuides& frame : frames) {
    for (Plane<float>& plane : frame.motion) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) plane(x, y) = noise(random);
      }
    }
  }
  EXPECT_FALSE(find_motion(frames).is_clear);
}

TEST(MotionReading, RefusesWhatHasNoFeatures) {
  AnalyticShot shot;
  std::vector<RawGuides> frames = shot_of(shot, reading_of("x,y", shot), false);
  for (RawGuides& frame : frames) {
    frame.depth.fill(2.0f);
    for (Plane<float>& plane : frame.normal) plane.fill(0.5f);
    for (Plane<float>& plane : frame.albedo) plane.fill(0.5f);
  }
  const MotionFit fit = find_motion(frames);
  EXPECT_FALSE(fit.is_clear);
}

TEST(MotionReading, SaysThatThereIsNoMotion) {
  const AnalyticShot shot;
  std::vector<RawGuides> frames = shot_of(shot, reading_of("x,y", shot), false);
  for (RawGuides& frame : frames) frame.motion.clear();
  const MotionFit fit = find_motion(frames);
  EXPECT_FALSE(fit.is_clear);
  EXPECT_THAT(fit.words, HasSubstr("hold none"));
}

TEST(MotionReading, ThrowsOnFramesOfTwoSizes) {
  AnalyticShot small, large;
  large.extent = {170, 90};
  std::vector<RawGuides> frames;
  frames.push_back(small.frame(0));
  EXPECT_THROW((void)find_motion(frames), std::invalid_argument);
  frames.push_back(large.frame(1));
  EXPECT_THROW((void)find_motion(frames), std::invalid_argument);
}

TEST(ParseMotion, KnowsPresetsAndWords) {
  const Extent extent{320, 180};
  EXPECT_EQ(parse_motion("cycles", extent), (MotionReading{0, 1, -1, true}));
  EXPECT_EQ(parse_motion("optix", extent), (MotionReading{0, -1, -1, true}));
  EXPECT_EQ(parse_motion("none", extent), std::nullopt);
  EXPECT_EQ(parse_motion("x,-y,pixels,backward", extent), (MotionReading{0, 1, -1, true}));
  EXPECT_EQ(parse_motion("second, forward, ndc, -x, y", extent),
            (MotionReading{1, -160, 90, false}));
  EXPECT_EQ(parse_motion("uv", extent), (MotionReading{0, 320, 180, true}));
  EXPECT_EQ(parse_motion("-y,8.5", extent), (MotionReading{0, 8.5, -8.5, true}));
  EXPECT_EQ(parse_motion(".25uv", extent), (MotionReading{0, 80, 45, true}));
}

TEST(ParseMotion, ReadsWhatFormatMotionWrites) {
  const Extent extent{320, 180};
  for (const char* text : {"x,-y,pixels,backward", "-x,y,uv,forward,second", "x,y,ndc,forward",
                           "-x,-y,3.5,backward", "x,y,0.3uv,backward,second"}) {
    EXPECT_EQ(format_motion(*parse_motion(text, extent), extent), text);
  }
}

TEST(ParseMotion, NamesWhatItDoesNotKnow) {
  const auto error_of = [](const char* text) -> std::string {
    try {
      (void)parse_motion(text, {320, 180});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of("blender"), HasSubstr("unknown 'blender'"));
  EXPECT_THAT(error_of("blender"), HasSubstr("cycles (x,-y,pixels,backward)"));
  EXPECT_THAT(error_of("x,-x"), HasSubstr("'-x' in 'x,-x'"));
  EXPECT_THAT(error_of("x,,y"), HasSubstr("unknown ''"));
  EXPECT_THAT(error_of("-3"), HasSubstr("unknown '-3'"));
  EXPECT_THAT(error_of("3px"), HasSubstr("unknown '3px'"));
  EXPECT_THAT(error_of(""), HasSubstr("unknown ''"));
}

}  // namespace
}  // namespace eigenlight
