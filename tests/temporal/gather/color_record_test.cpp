#include "temporal/gather/color_record.h"

#include <gtest/gtest.h>

#include <limits>

namespace eigenlight {
namespace {

constexpr Extent kExtent{20, 12};

Planes<3> filled(float r, float g, float b) {
  Planes<3> planes = make_planes<3>(kExtent);
  planes[0].fill(r), planes[1].fill(g), planes[2].fill(b);
  return planes;
}

TEST(ColorRecord, KeepsColorsToAStep) {
  Planes<3> color = filled(0.123f, 1.9f, 0.0f);
  color[0](3, 4) = std::numeric_limits<float>::infinity();
  color[1](5, 4) = -0.1f;
  color[2](6, 4) = 2.1f;
  ColorRecord record;
  record_color(color, record);
  EXPECT_NEAR(static_cast<float>(record(0, 0).r) * kColorStep, 0.123f, 0.5f * kColorStep);
  EXPECT_NEAR(static_cast<float>(record(0, 0).g) * kColorStep, 1.9f, 0.5f * kColorStep);
  EXPECT_EQ(record(0, 0).b, 0);
  EXPECT_EQ(record(0, 0).usable, 1);
  for (const int x : {3, 5, 6}) EXPECT_EQ(record(x, 4).usable, 0) << x;
}

TEST(ColorRecord, EmissionIsTheShareOfItsSurroundings) {
  Planes<3> emission = filled(0.0f, 0.0f, 0.0f);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < 10; ++x) emission[0](x, y) = x < 9 ? 30.0f : 7.5f;
  }
  emission[1](2, 2) = std::numeric_limits<float>::quiet_NaN();
  ColorRecord record;
  Plane<float> scale;
  record_emission(emission, record, scale);
  EXPECT_EQ(scale(4, 4), 30.0f);
  EXPECT_EQ(scale(9, 4), 30.0f);
  EXPECT_EQ(scale(15, 4), 1.0f);
  EXPECT_NEAR(static_cast<float>(record(9, 4).r) * kColorStep, 0.25f, kColorStep);
  EXPECT_EQ(record(9, 4).usable, 1);
  EXPECT_EQ(record(10, 4).usable, kCertainColor);
  EXPECT_EQ(record(2, 2).usable, 0);
  // A lamp that pulses is the same record.
  for (float& value : emission[0].storage()) value *= 0.1f;
  ColorRecord dim;
  record_emission(emission, dim, scale);
  EXPECT_EQ(scale(9, 4), 3.0f);
  EXPECT_EQ(dim(9, 4).r, record(9, 4).r);
}

}  // namespace
}  // namespace eigenlight
