#include "temporal/samples/firefly_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frame/luminance.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{40, 24};

// Gray light of 1, predicted so, of variance 0.01, at age 4: sigma is sqrt(0.0125 + 0.01) = 0.15.
struct Wall {
  Planes<3> residual = make_planes<3>(kExtent);
  Plane<float> innovation{kExtent}, expected{kExtent}, age{kExtent}, samples{kExtent},
      variance{kExtent};
  FireflyBound bound{kExtent, {}};

  Wall() {
    expected.fill(1.0f);
    age.fill(4.0f);
    samples.fill(1.0f);
    variance.fill(0.01f);
  }
  void set(int x, int y, float value) {
    for (auto& plane : residual) plane(x, y) = value - 1.0f;
    innovation(x, y) = value - 1.0f;
  }
  // A new pixel: all of its light is unexpected.
  void set_new(int x, int y, float value) {
    for (auto& plane : residual) plane(x, y) = value;
    innovation(x, y) = NAN;
    expected(x, y) = age(x, y) = 0.0f;
  }
  [[nodiscard]] float light(int channel, int x, int y) const {
    return expected(x, y) + residual[static_cast<std::size_t>(channel)](x, y);
  }
  std::int64_t process() {
    const FireflyInputs in{expected, age, samples, variance};
    const FireflyOutputs out{residual, innovation};
    bound.count(in, out, {0, 0, kExtent.width, kExtent.height});
    return bound.bound(in, out, [&](const Tile& block) { changed.push_back(block.index); });
  }
  std::vector<int> changed;
};

// With a history of n frames, the mean moves by 1 / (n + 1) of the sample's distance.
TEST(FireflyBound, ALoneOutlierMovesTheMeanByOneOfItsDeviations) {
  for (const float n : {1.0f, 4.0f, 16.0f, 60.0f}) {
    Wall p;
    p.age.fill(n);
    p.set(13, 9, 1000.0f);
    EXPECT_EQ(p.process(), 1);
    const float sigma = std::sqrt(0.01f * (1.0f + 1.0f / n) + 0.01f);
    EXPECT_NEAR(p.residual[1](13, 9) / (n + 1.0f), sigma / std::sqrt(n), 1e-4f) << n;
  }
}

TEST(FireflyBound, ALoneOutlierKeepsItsHueAndConfirmsNothing) {
  Wall p;
  p.residual[0](13, 9) = 3000.0f;
  p.residual[1](13, 9) = 1000.0f;
  p.innovation(13, 9) = luminance(p.residual, 13, 9);
  EXPECT_EQ(p.process(), 1);
  EXPECT_TRUE(std::isnan(p.innovation(13, 9)));
  EXPECT_EQ(p.innovation(14, 9), 0.0f);
  EXPECT_EQ(p.changed, std::vector{6});
  // Of age 4: 5 / 2 deviations.
  const float allowed = 2.5f * std::sqrt(0.01f * 1.25f + 0.01f);
  EXPECT_NEAR(luminance(p.residual, 13, 9), allowed, 1e-4f);
  EXPECT_NEAR(p.residual[0](13, 9) / p.residual[1](13, 9), 3.0f, 1e-4f);
  EXPECT_EQ(p.residual[2](13, 9), 0.0f);
}

TEST(FireflyBound, WhatIsWithinReachStays) {
  Wall p;
  p.set(13, 9, 1.0f + 7.9f * 0.15f);
  p.set(20, 9, 1.0f - 7.9f * 0.15f);
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.light(1, 13, 9), 1.0f + 7.9f * 0.15f);
  EXPECT_TRUE(p.changed.empty());
}

TEST(FireflyBound, ALightThatChangesIsNoFirefly) {
  Wall p;
  for (int y = 0; y < 24; ++y) {
    for (int x = 8; x < 24; ++x) p.set(x, y, 100.0f);
  }
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.residual[0](12, 12), 99.0f);
  EXPECT_EQ(p.innovation(12, 12), 99.0f);
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
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) p.set_new(x, y, 1.0f);
  }
  p.set_new(13, 9, 1e6f);
  EXPECT_EQ(p.process(), 1);
  // 576 pixels around, one of them with sqrt(1e6) = 1000.
  const float root = (575.0f + 1000.0f) / 576.0f;
  EXPECT_NEAR(p.light(1, 13, 9), 16.0f * root * root, 0.1f);
  EXPECT_EQ(p.light(1, 14, 9), 1.0f);
  EXPECT_NEAR(p.bound.brightness()(1, 1), 16.0f * root * root, 0.1f);
}

TEST(FireflyBound, BrightnessIsBoundedOnlyNearNewPixels) {
  Wall p;
  p.set_new(39, 0, 1.0f);
  EXPECT_EQ(p.process(), 0);
  EXPECT_FLOAT_EQ(p.bound.brightness()(4, 0), 16.0f);
  EXPECT_FLOAT_EQ(p.bound.brightness()(3, 1), 16.0f);
  EXPECT_TRUE(std::isinf(p.bound.brightness()(2, 0)));
}

TEST(FireflyBound, WhatIsNotUsableIsLeftAlone) {
  Wall p;
  p.samples(13, 9) = 0.0f;
  p.innovation(13, 9) = p.residual[0](13, 9) = NAN;
  EXPECT_EQ(p.process(), 0);
  EXPECT_TRUE(std::isnan(p.residual[0](13, 9)));
}

TEST(FireflyBound, RefusesBadOptions) {
  EXPECT_THROW(FireflyBound(kExtent, {.deviations = 0.5f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.times = 0.0f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.share = 0.0f}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
