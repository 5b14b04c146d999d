#include "temporal/gather/even_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/random.h"
#include "frame/tiles.h"
#include "tests/support/compare.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{200, 120};

// Exponential noise around `mean(x)`.
LightRecord noisy_record(float (*mean)(int x)) {
  LightRecord record(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const float light = -mean(x) * std::log1p(-to_unit(hash_key(9, x, y, 0)));
      record(x, y) = {light, light, light, light, 0.0f, 0.0f, 1.0f, 0.0f};
    }
  }
  return record;
}

Planes<3> filled(float value) {
  Planes<3> light = make_planes<3>(kExtent);
  for (auto& plane : light) plane.fill(value);
  return light;
}

double mean_of(const Planes<3>& light, int x0, int x1) {
  double sum = 0.0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = x0; x < x1; ++x) sum += static_cast<double>(light[1](x, y));
  }
  return sum / (x1 - x0) / kExtent.height;
}

TEST(EvenLight, GivesBackWhatWasLost) {
  const LightRecord own = noisy_record([](int) { return 2.0f; });
  for (const float lost : {0.7f, 0.95f, 1.2f}) {
    Planes<3> light = filled(2.0f * lost);
    even_light(own, light);
    EXPECT_NEAR(mean_of(light, 0, 200), 2.0, 0.03) << lost;
    // A whole region knows what a pixel does not.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light[c](100, 60), 2.0f, 0.12f);
  }
}

TEST(EvenLight, GivesItBackWhereItWasLost) {
  const LightRecord own = noisy_record([](int) { return 2.0f; });
  Planes<3> light = filled(2.0f);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < 60; ++x) light[0](x, y) = light[1](x, y) = light[2](x, y) = 1.5f;
  }
  even_light(own, light);
  EXPECT_NEAR(mean_of(light, 0, 20), 2.0, 0.06);
  EXPECT_NEAR(mean_of(light, 140, 200), 2.0, 0.06);
}

TEST(EvenLight, ALightThatIsRightStays) {
  LightRecord own(kExtent);
  own.fill({3.0f, 2.0f, 1.0f, 2.0f, 0.0f, 0.0f, 1.0f, 0.0f});
  Planes<3> light = filled(0.0f);
  light[0].fill(3.0f), light[1].fill(2.0f), light[2].fill(1.0f);
  even_light(own, light);
  EXPECT_FLOAT_EQ(light[0](7, 9), 3.0f);
  EXPECT_FLOAT_EQ(light[2](199, 119), 1.0f);
}

TEST(EvenLight, BadAndDarkPixelsHarmNothing) {
  LightRecord own(kExtent);
  own.fill({1.0f, 1.0f, 1.0f, 1.0f, 0.0f, 0.0f, 1.0f, 0.0f});
  own(50, 50) = {};
  Planes<3> light = filled(1.0f);
  light[0](20, 20) = std::numeric_limits<float>::quiet_NaN();
  even_light(own, light);
  EXPECT_FLOAT_EQ(light[1](50, 50), 1.0f);
  EXPECT_FLOAT_EQ(light[0](21, 20), 1.0f);
  Planes<3> dark = filled(0.0f);
  even_light(own, dark);
  EXPECT_EQ(dark[0](10, 10), 0.0f);
  // A sample of a million times the light of all others.
  own(100, 60) = {1e9f, 1e9f, 1e9f, 1.0f, 0.0f, 0.0f, 1.0f, 0.0f};
  Planes<3> bounded = filled(1.0f);
  even_light(own, bounded);
  EXPECT_LE(bounded[0](100, 60), 2.0f);
}

TEST(EvenLight, SameBitsOnAnyNumberOfThreads) {
  const LightRecord own = noisy_record([](int x) { return 1.0f + 0.01f * static_cast<float>(x); });
  Planes<3> one = filled(1.7f), two = filled(1.7f);
  set_thread_count(1);
  even_light(own, one);
  set_thread_count(2);
  even_light(own, two);
  set_thread_count(0);
  EXPECT_TRUE(planes_equal(one, two));
}

}  // namespace
}  // namespace eigenlight
