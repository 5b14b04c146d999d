#include "sequences/exr/exr_colors.h"

#include <gtest/gtest.h>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

void expect_weights(const ExrChromaticities& primaries, const std::array<double, 3>& wanted) {
  const auto found = luminance_weights(primaries);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 1e-4) << c;
}

TEST(ExrColors, WeightsAreThoseOfTheStandards) {
  expect_weights(rec709_chromaticities(), {kLuminance[0], kLuminance[1], kLuminance[2]});
  // S-2014-004: ACEScg; its matrix to XYZ has 0.2722287, 0.6740818, 0.0536895 in row Y.
  expect_weights({{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}},
                 {0.2722287, 0.6740818, 0.0536895});
  // Rec. 2020.
  expect_weights({{0.708f, 0.292f}, {0.17f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.329f}},
                 {0.2627, 0.6780, 0.0593});
  // XYZ itself: Y is the second channel.
  expect_weights({{1.0f, 0.0f}, {0.0f, 1.0f}, {0.0f, 0.0f}, {1.0f / 3.0f, 1.0f / 3.0f}},
                 {0.0, 1.0, 0.0});
}

TEST(ExrColors, WhatIsNoSetOfPrimariesIsTakenAsRec709) {
  const std::array<double, 3> rec709{kLuminance[0], kLuminance[1], kLuminance[2]};
  expect_weights({}, rec709);
  expect_weights({{0.1f, 0.1f}, {0.2f, 0.2f}, {0.3f, 0.3f}, {0.3f, 0.3f}}, rec709);
  expect_weights({{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3f, 0.0f}}, rec709);
}

TEST(ExrColors, RoundingIsNoOtherColor) {
  ExrChromaticities a = rec709_chromaticities();
  a.white[0] += 0.0005f;
  EXPECT_TRUE(same_colors(a, rec709_chromaticities()));
  a.white[0] += 0.002f;
  EXPECT_FALSE(same_colors(a, rec709_chromaticities()));
}

}  // namespace
}  // namespace eigenlight
