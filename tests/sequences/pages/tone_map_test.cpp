#include "sequences/pages/tone_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "sequences/pages/thin_frames.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;

Planes<3> filled(Extent extent, float value) {
  Planes<3> colors = make_planes<3>(extent);
  for (Plane<float>& plane : colors) plane.fill(value);
  return colors;
}

std::array<int, 3> pixel(const Plane<std::uint8_t>& picture, int x, int y) {
  const std::uint8_t* at = picture.at(x, y);
  return {at[0], at[1], at[2]};
}

int gray(float value, float exposure) {
  return pixel(ToneMap(exposure).apply(filled({1, 1}, value), 1), 0, 0)[0];
}

// IEC 61966-2-1.
int srgb(double v) {
  const double curve = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
  return static_cast<int>(std::lround(255.0 * curve));
}

TEST(ToneMap, IsTheSrgbCurveOfExposureTimesLight) {
  for (const double v : {0.0, 0.001, 0.01, 0.18, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(gray(static_cast<float>(v), 1.0f), srgb(v), 1) << v;
    EXPECT_NEAR(gray(static_cast<float>(4.0 * v), 0.25f), srgb(v), 1) << v;
  }
  EXPECT_EQ(gray(7.0f, 1.0f), 255);
  EXPECT_EQ(gray(-1.0f, 1.0f), 0);
}

TEST(ToneMap, TakesTheMeanOfBlocksAndCutsOffTheRest) {
  Planes<3> colors = filled({5, 3}, 0.0f);
  colors[0](0, 0) = 1.0f;
  colors[0](1, 1) = 1.0f;
  const Plane<std::uint8_t> picture = ToneMap(1.0f).apply(colors, 2);
  EXPECT_EQ(picture.extent(), (Extent{2, 1}));
  EXPECT_NEAR(pixel(picture, 0, 0)[0], srgb(0.5), 1);
  EXPECT_EQ(pixel(picture, 0, 0)[1], 0);
  EXPECT_EQ(pixel(picture, 1, 0)[0], 0);
  EXPECT_EQ(ToneMap::shrunk({5, 3}, 9), (Extent{1, 1}));
}

TEST(ToneMap, ShowsNaNAndInfAsMagenta) {
  const FloatTrapsOff because_of_inf;
  Planes<3> colors = filled({3, 1}, 0.2f);
  colors[1](0, 0) = std::numeric_limits<float>::quiet_NaN();
  colors[2](1, 0) = std::numeric_limits<float>::infinity();
  const Plane<std::uint8_t> picture = ToneMap(1.0f).apply(colors, 1);
  EXPECT_THAT(pixel(picture, 0, 0), ElementsAre(255, 0, 255));
  EXPECT_THAT(pixel(picture, 1, 0), ElementsAre(255, 0, 255));
  EXPECT_EQ(pixel(picture, 2, 0)[1], pixel(picture, 2, 0)[0]);
}

TEST(ThinFrames, KeepsEvenStepsFromTheFirstOn) {
  EXPECT_THAT(thin_frames({1, 2, 3}, 3), ElementsAre(1, 2, 3));
  EXPECT_THAT(thin_frames({1, 2, 3, 4, 5, 6, 7}, 3), ElementsAre(1, 4, 7));
  EXPECT_TRUE(thin_frames({}, 3).empty());
}

}  // namespace
}  // namespace eigenlight
