#include "sequences/metrics/equal_time.h"

#include <gtest/gtest.h>

#include <cmath>

namespace eigenlight {
namespace {

TEST(EqualTime, IsALineInLogLog) {
  // error = 3 / ms^2: a straight line in log-log, so every reading is exact.
  std::vector<CurvePoint> points;
  for (const double ms : {80.0, 5.0, 20.0}) points.push_back({ms, 3.0 / (ms * ms)});
  for (const double ms : {5.0, 6.5, 20.0, 33.0, 80.0}) {
    const auto error = error_at_time(points, ms);
    ASSERT_TRUE(error) << ms;
    EXPECT_NEAR(*error, 3.0 / (ms * ms), 1e-12) << ms;
  }
}

TEST(EqualTime, NeverLeavesTheMeasuredTimes) {
  const std::vector<CurvePoint> points{{10.0, 0.2}, {20.0, 0.1}};
  EXPECT_FALSE(error_at_time(points, 9.999));
  EXPECT_FALSE(error_at_time(points, 20.001));
  EXPECT_FALSE(error_at_time({}, 10.0));
  EXPECT_FALSE(error_at_time({{10.0, 0.2}}, 11.0));
  EXPECT_EQ(error_at_time({{10.0, 0.2}}, 10.0), 0.2);
}

TEST(EqualTime, LeavesOutWhatHasNoLogarithm) {
  // An unbiased error may be below 0.
  const std::vector<CurvePoint> points{{10.0, 0.2}, {20.0, -0.001}, {40.0, 0.1}, {80.0, 0.05}};
  EXPECT_FALSE(error_at_time(points, 15.0));
  EXPECT_FALSE(error_at_time(points, 20.0));
  EXPECT_FALSE(error_at_time(points, 30.0));
  EXPECT_NEAR(error_at_time(points, std::sqrt(40.0 * 80.0)).value(), std::sqrt(0.1 * 0.05), 1e-12);
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<CurvePoint> points{{1.0, 9.0}, {2.0, 5.0}, {3.0, 5.0}, {2.0, 6.0}, {4.0, 1.0}};
  EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, false, false, true}));
  EXPECT_EQ(pareto_front({{1.0, 1.0}, {1.0, 1.0}}), (std::vector<bool>{true, true}));
  EXPECT_TRUE(pareto_front({}).empty());
}

}  // namespace
}  // namespace eigenlight
