#include "sequences/pages/auto_exposure.h"

#include <gtest/gtest.h>

#include <limits>

namespace eigenlight {
namespace {

Planes<3> gray(float light) {
  Planes<3> picture = make_planes<3>({4, 3});
  for (auto& plane : picture) plane.fill(light);
  return picture;
}

TEST(AutoExposure, BringsTheLogarithmicMeanToMiddleGrayInStops) {
  EXPECT_EQ(auto_exposure(gray(0.18f)), 1.0f);
  EXPECT_EQ(auto_exposure(gray(0.25f)), 1.0f);
  EXPECT_EQ(auto_exposure(gray(0.045f)), 4.0f);
  EXPECT_EQ(auto_exposure(gray(1440.0f)), 1.0f / 8192.0f);
}

TEST(AutoExposure, LooksAtPixelsWithLightOnly) {
  Planes<3> picture = gray(0.72f);
  for (auto& plane : picture) {
    plane(0, 0) = 0.0f;
    plane(1, 0) = -5.0f;
    plane(2, 0) = std::numeric_limits<float>::quiet_NaN();
    plane(3, 0) = std::numeric_limits<float>::infinity();
  }
  EXPECT_EQ(auto_exposure(picture), 0.25f);
  EXPECT_EQ(auto_exposure(gray(0.0f)), 1.0f);
  EXPECT_EQ(auto_exposure(gray(1e30f)), std::exp2(-20.0f));
}

}  // namespace
}  // namespace eigenlight
