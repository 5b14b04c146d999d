#include "temporal/firefly_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{40, 24};

// Gray light of 1, predicted so, of variance 0.01, at age 4: sigma is sqrt(0.0125 + 0.01) = 0.15.
struct Wall {
  Planes<3> prediction = make_planes<3>(kExtent), light = make_planes<3>(kExtent);
  Plane<float> confirmed{kExtent}, age{kExtent}, samples{kExtent}, variance{kExtent},
      residual{kExtent};
  FireflyBound bound{kExtent, {}};

  Wall() {
    for (auto& plane : prediction) plane.fill(1.0f);
    for (auto& plane : light) plane.fill(1.0f);
    confirmed.fill(1.0f);
    age.fill(4.0f);
    samples.fill(1.0f);
    variance.fill(0.01f);
  }
  void set(int x, int y, float value) {
    for (auto& plane : light) plane(x, y) = value;
    residual(x, y) = value - 1.0f;
  }
  std::int64_t process() {
    const FireflyInputs in{prediction, age, samples, variance};
    const FireflyOutputs out{light, residual, confirmed};
    bound.count(in, out, {0, 0, kExtent.width, kExtent.height, 0});
    return bound.bound(in, out);
  }
};

// With a history of n frames, the mean moves by 1 / (n + 1) of the sample's distance.
TEST(FireflyBound, ALoneOutlierMovesTheMeanByOneOfItsDeviations) {
  for (const float n : {1.0f, 4.0f, 16.0f, 60.0f}) {
    Wall p;
    p.age.fill(n);
    p.set(13, 9, 1000.0f);
    EXPECT_EQ(p.process(), 1);
    const float sigma = std::sqrt(0.01f * (1.0f + 1.0f / n) + 0.01f);
    EXPECT_NEAR((p.light[1](13, 9) - 1.0f) / (n + 1.0f), sigma / std::sqrt(n), 1e-4f) << n;
  }
}

TEST(FireflyBound, ALoneOutlierKeepsItsHueAndConfirmsNothing) {
  Wall p;
  p.light[0](13, 9) = 3001.0f;
  p.light[1](13, 9) = 1001.0f;
  p.light[2](13, 9) = 1.0f;
  p.residual(13, 9) = luminance(p.light, 13, 9) - 1.0f;
  EXPECT_EQ(p.process(), 1);
  EXPECT_EQ(p.residual(13, 9), 0.0f);
  EXPECT_EQ(p.confirmed(13, 9), 0.0f);
  EXPECT_EQ(p.confirmed(14, 9), 1.0f);
  // Of age 4: 5 / 2 deviations.
  const float allowed = 2.5f * std::sqrt(0.01f * 1.25f + 0.01f);
  EXPECT_NEAR(luminance(p.light, 13, 9) - 1.0f, allowed, 1e-4f);
  EXPECT_NEAR((p.light[0](13, 9) - 1.0f) / (p.light[1](13, 9) - 1.0f), 3.0f, 1e-4f);
  EXPECT_EQ(p.light[2](13, 9), 1.0f);
}

TEST(FireflyBound, WhatIsWithinReachStays) {
  Wall p;
  p.set(13, 9, 1.0f + 7.9f * 0.15f);
  p.set(20, 9, 1.0f - 7.9f * 0.15f);
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.light[1](13, 9), 1.0f + 7.9f * 0.15f);
}

TEST(FireflyBound, ALightThatChangesIsNoFirefly) {
  Wall p;
  for (int y = 0; y < 24; ++y) {
    for (int x = 8; x < 24; ++x) p.set(x, y, 100.0f);
  }
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.light[0](12, 12), 100.0f);
  EXPECT_EQ(p.residual(12, 12), 99.0f);
}

// A twelfth of the pixels around, but a third of their own block: an edge of light that moves.
TEST(FireflyBound, OutliersSideBySideAreNoFireflies) {
  for (const int rows : {1, 3}) {
    Wall p;
    for (int y = 8; y < 8 + rows; ++y) {
      for (int x = 8; x < 16; ++x) p.set(x, y, 100.0f);
    }
    EXPECT_EQ(p.process(), rows == 1 ? 8 : 0);
  }
}

TEST(FireflyBound, NewPixelsAreHeldAgainstTheLightAroundThem) {
  Wall p;
  p.confirmed.fill(0.0f);
  p.set(13, 9, 1e6f);
  EXPECT_EQ(p.process(), 1);
  // 576 pixels around, one of them with sqrt(1e6) = 1000.
  const float root = (575.0f + 1000.0f) / 576.0f;
  EXPECT_NEAR(p.light[1](13, 9), 16.0f * root * root, 0.1f);
  EXPECT_EQ(p.light[1](14, 9), 1.0f);
  EXPECT_NEAR(p.bound.brightness()(1, 1), 16.0f * root * root, 0.1f);
}

TEST(FireflyBound, BrightnessIsBoundedOnlyNearNewPixels) {
  Wall p;
  p.confirmed(39, 0) = 0.0f;
  EXPECT_EQ(p.process(), 0);
  EXPECT_FLOAT_EQ(p.bound.brightness()(4, 0), 16.0f);
  EXPECT_FLOAT_EQ(p.bound.brightness()(3, 1), 16.0f);
  EXPECT_TRUE(std::isinf(p.bound.brightness()(2, 0)));
}

TEST(FireflyBound, WhatIsNotUsableIsLeftAlone) {
  Wall p;
  p.confirmed(13, 9) = p.samples(13, 9) = 0.0f;
  p.light[0](13, 9) = NAN;
  EXPECT_EQ(p.process(), 0);
  EXPECT_TRUE(std::isnan(p.light[0](13, 9)));
}

TEST(FireflyBound, RefusesBadOptions) {
  EXPECT_THROW(FireflyBound(kExtent, {.deviations = 0.5f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.times = 0.0f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.share = 0.0f}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
