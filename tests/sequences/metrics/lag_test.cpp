#include "sequences/metrics/lag.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace eigenlight {
namespace {

constexpr int kStep = 10;

/// Frames 0 to 59; the light steps from `before` to `after` at frame 10 and the test has followed
/// `share(n)` of it n frames later.
struct Sequence {
  double before = 1.0, after = 3.0;
  std::function<double(int)> share = [](int) { return 1.0; };
  double bias = 1.0;                                          ///< factor of the test
  std::function<double(int)> view = [](int) { return 1.0; };  ///< factor of both: a moving camera

  [[nodiscard]] std::vector<LightLevel> levels() const {
    std::vector<LightLevel> levels;
    for (int frame = 0; frame < 60; ++frame) {
      const double light = frame < kStep ? before : after;
      const double shown =
          frame < kStep ? before : before + share(frame - kStep) * (after - before);
      const double error = (shown - light) * (shown - light);
      levels.push_back({frame, bias * view(frame) * shown, view(frame) * light, error});
    }
    return levels;
  }
};

/// One that keeps exp(-1 / constant) of what is missing from frame to frame.
auto exponential(double constant) {
  return [constant](int n) { return 1.0 - std::exp(-(n + 1) / constant); };
}

TEST(Lag, ExponentialApproachHasAClosedForm) {
  for (const double constant : {0.7, 2.0, 4.5, 9.0}) {
    const auto lag = measure_lag(Sequence{.share = exponential(constant)}.levels(), kStep);
    ASSERT_TRUE(lag && lag->frames) << constant;
    // exp(-(n + 1) / constant) <= 0.1
    const int frames = static_cast<int>(std::ceil(constant * std::log(10.0))) - 1;
    EXPECT_EQ(*lag->frames, frames) << constant;
    // Squares of 2 exp(-(n + 1) / constant), a geometric series.
    const double ratio = std::exp(-2.0 / constant);
    EXPECT_NEAR(*lag->error, 4.0 * ratio * (1.0 - std::pow(ratio, frames + 1)) / (1.0 - ratio),
                1e-12);
    EXPECT_NEAR(lag->reached.at(kStep + 3), 1.0 - std::exp(-4.0 / constant), 1e-12);
  }
}

TEST(Lag, InstantIsZero) {
  const auto lag = measure_lag(Sequence{}.levels(), kStep);
  ASSERT_TRUE(lag && lag->frames);
  EXPECT_EQ(*lag->frames, 0);
  EXPECT_EQ(*lag->error, 0.0);
  EXPECT_EQ(lag->reached.size(), 50u);
  EXPECT_EQ(lag->reached.count(kStep - 1), 0u);
}

TEST(Lag, NeverReachedIsAbsent) {
  const auto lag = measure_lag(Sequence{.share = [](int) { return 0.89; }}.levels(), kStep);
  ASSERT_TRUE(lag.has_value());
  EXPECT_FALSE(lag->frames.has_value());
  EXPECT_FALSE(lag->error.has_value());
  EXPECT_NEAR(lag->reached.at(59), 0.89, 1e-12);
}

TEST(Lag, StepsDownAndUpLagAlike) {
  for (const double after : {0.1, 0.85, 1.2, 50.0}) {
    const auto lag =
        measure_lag(Sequence{.after = after, .share = exponential(3.0)}.levels(), kStep);
    ASSERT_TRUE(lag && lag->frames) << after;
    EXPECT_EQ(*lag->frames, 6) << after;  // 3 ln 10 = 6.9
  }
}

TEST(Lag, BiasOfTheMethodAndMovesOfTheCameraDoNotCount) {
  const auto view = [](int frame) { return 1.0 + 0.3 * std::sin(0.1 * frame); };
  const Sequence sequence{.share = exponential(3.0), .bias = 0.8, .view = view};
  const auto lag = measure_lag(sequence.levels(), kStep);
  ASSERT_TRUE(lag && lag->frames);
  // The view changes between frames 9 and 10 too: by 1 %, which the step of the mean contains.
  EXPECT_EQ(*lag->frames, 6);
  EXPECT_NEAR(lag->reached.at(30), 1.0, 0.01);
}

TEST(Lag, LightThatWasOff) {
  const auto lag = measure_lag(Sequence{.before = 0.0, .share = exponential(3.0)}.levels(), kStep);
  ASSERT_TRUE(lag && lag->frames);
  EXPECT_EQ(*lag->frames, 6);
}

TEST(Lag, IsAbsentWithoutAStep) {
  const std::vector<LightLevel> levels = Sequence{}.levels();
  for (const int step : {0, 9, 11, 60}) EXPECT_FALSE(measure_lag(levels, step).has_value()) << step;
  EXPECT_FALSE(measure_lag(Sequence{.after = 1.05}.levels(), kStep).has_value());
  EXPECT_FALSE(measure_lag(Sequence{.after = 0.0}.levels(), kStep).has_value());
  EXPECT_FALSE(measure_lag({}, kStep).has_value());
  std::vector<LightLevel> gap = levels;
  gap.erase(gap.begin() + kStep - 1);
  EXPECT_FALSE(measure_lag(gap, kStep).has_value());
}

TEST(Lag, AFrameMissingOnTheWayLeavesTheLagUnknown) {
  std::vector<LightLevel> levels = Sequence{.share = exponential(3.0)}.levels();
  std::vector<LightLevel> later = levels;
  later.erase(later.begin() + kStep + 20);
  EXPECT_EQ(measure_lag(later, kStep)->frames, 6);
  levels.erase(levels.begin() + kStep + 4);
  const auto lag = measure_lag(levels, kStep);
  ASSERT_TRUE(lag.has_value());
  EXPECT_FALSE(lag->frames.has_value());
  EXPECT_TRUE(lag->reached.count(kStep + 6));
}

TEST(Lag, OrderOfFramesDoesNotMatter) {
  std::vector<LightLevel> levels = Sequence{.share = exponential(3.0)}.levels();
  std::reverse(levels.begin(), levels.end());
  EXPECT_EQ(measure_lag(levels, kStep)->frames, 6);
}

}  // namespace
}  // namespace eigenlight
