#include "temporal/gather/light_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "frame/random.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
// Six by four cells, the last ones cut.
constexpr Extent kExtent{90, 60};

Planes<3> picture(const std::function<float(int, int)>& light) {
  Planes<3> planes = make_planes<3>(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      for (auto& plane : planes) plane(x, y) = light(x, y);
    }
  }
  return planes;
}

FrameLink moved(float x, float y) {
  FrameLink link(kExtent);
  link.fill({x, y, 0.0f, 1.0f});
  return link;
}

// Heavy noise of mean 1.
float noise(int x, int y, std::uint32_t key) {
  return -std::log(1.0f - to_unit(hash_key(key, x, y)));
}

TEST(LightChange, FindsAKnownGain) {
  LightChange change;
  const auto light = [](int x, int y) {
    return 1.0f + 0.5f * std::sin(0.2f * static_cast<float>(x + 2 * y));
  };
  change.find(picture([&](int x, int y) { return 1.7f * light(x + 3, y - 2); }), picture(light),
              moved(3.0f, -2.0f));
  for (float y = -3.0f; y < 63.0f; y += 2.3f) {
    for (float x = -3.0f; x < 93.0f; x += 2.3f) ASSERT_NEAR(change.at(x, y), 1.7f, 1e-5f);
  }
}

TEST(LightChange, NoiseThatBothShareCancels) {
  const Planes<3> here = picture([](int x, int y) { return noise(x, y, 1); });
  const Planes<3> there = picture([](int x, int y) { return noise(x + 1, y + 2, 1); });
  const Planes<3> other = picture([](int x, int y) { return noise(x, y, 2); });
  LightChange same, apart;
  same.find(here, there, moved(-1.0f, -2.0f));
  apart.find(here, other, moved(-1.0f, -2.0f));
  float most = 0.0f;
  for (float x = 0.0f; x < 90.0f; x += 3.0f) {
    ASSERT_FLOAT_EQ(same.at(x, 30.0f), 1.0f);
    most = std::max(most, std::abs(apart.at(x, 30.0f) - 1.0f));
  }
  EXPECT_GT(most, 0.01f);
}

TEST(LightChange, IsBounded) {
  LightChange change;
  const Planes<3> one = picture([](int, int) { return 1.0f; });
  change.find(picture([](int, int) { return 100.0f; }), one, moved(0, 0));
  EXPECT_EQ(change.at(40.0f, 30.0f), 16.0f);
  change.find(one, picture([](int, int) { return 100.0f; }), moved(0, 0));
  EXPECT_EQ(change.at(40.0f, 30.0f), 1.0f / 16.0f);
}

TEST(LightChange, IsOneWhereNothingIsKnown) {
  LightChange change;
  const Planes<3> one = picture([](int, int) { return 1.0f; });
  const Planes<3> none = picture([](int, int) { return 0.0f; });
  const Planes<3> below = picture([](int, int) { return -2.0f; });
  for (const auto& [here, there] :
       {std::pair{&none, &one}, {&one, &none}, {&below, &one}, {&one, &below}, {&below, &below}}) {
    change.find(*here, *there, moved(0, 0));
    EXPECT_EQ(change.at(40.0f, 30.0f), 1.0f);
  }
  const Planes<3> three = picture([](int, int) { return 3.0f; });
  FrameLink unknown(kExtent);
  change.find(three, one, unknown);
  EXPECT_EQ(change.at(40.0f, 30.0f), 1.0f);
  change.find(three, one, moved(200.0f, 0.0f));
  EXPECT_EQ(change.at(40.0f, 30.0f), 1.0f);
}

// Pixels whose place is not known, or where either light is not finite, have quite other light.
TEST(LightChange, LeavesOutWhatIsNotKnown) {
  FrameLink link = moved(0, 0);
  Planes<3> here = picture([](int x, int y) { return 3.0f * noise(x, y, 5); });
  Planes<3> there = picture([](int x, int y) { return noise(x, y, 5); });
  for (int y = 0; y < 60; y += 3) {
    here[1](10, y) = kNan;
    here[0](20, y) = kInf;
    there[2](30, y) = kNan;
    there[1](40, y) = -kInf;
    here[1](50, y) = 1e6f;
    link(50, y) = {};
  }
  LightChange change;
  change.find(here, there, link);
  for (float y = 0.0f; y < 60.0f; y += 3.1f) {
    for (float x = 0.0f; x < 90.0f; x += 3.1f) ASSERT_NEAR(change.at(x, y), 3.0f, 1e-5f);
  }
}

// Gains of columns of cells, smoothed as the header says.
TEST(LightChange, IsARatioOfSmoothedSums) {
  constexpr double kGains[] = {1.0, 2.0, 0.5, 4.0, 1.5, 1.0}, kColumns[] = {16, 16, 16, 16, 16, 10};
  constexpr double kBinomial[] = {1, 4, 6, 4, 1};
  LightChange change;
  change.find(picture([&](int x, int) { return static_cast<float>(kGains[x / kChangeCell]); }),
              picture([](int, int) { return 1.0f; }), moved(0, 0));
  for (int cell = 0; cell < 6; ++cell) {
    double here = 0.0, there = 0.0;
    for (int d = -2; d <= 2; ++d) {
      if (cell + d < 0 || cell + d > 5) continue;
      const double weight = kBinomial[d + 2] * kColumns[cell + d];
      here += weight * kGains[cell + d];
      there += weight;
    }
    const float center = static_cast<float>(cell * kChangeCell) + 7.5f;
    for (const float y : {0.0f, 7.5f, 20.0f, 59.0f}) {
      EXPECT_NEAR(change.at(center, y), here / there, 1e-5) << cell;
    }
  }
}

TEST(LightChange, IsLinearBetweenCentersAndConstantBeyond) {
  LightChange change;
  change.find(
      picture([](int x, int y) { return 1.0f + static_cast<float>(x / 16 + 2 * (y / 16)); }),
      picture([](int, int) { return 1.0f; }), moved(0, 0));
  for (int cy = 0; cy < 3; ++cy) {
    for (int cx = 0; cx < 5; ++cx) {
      const float x = 16.0f * static_cast<float>(cx) + 7.5f,
                  y = 16.0f * static_cast<float>(cy) + 7.5f;
      const float a = change.at(x, y), b = change.at(x + 16.0f, y), c = change.at(x, y + 16.0f),
                  d = change.at(x + 16.0f, y + 16.0f);
      ASSERT_LT(a, b);
      ASSERT_LT(a, c);
      EXPECT_NEAR(change.at(x + 4.0f, y), 0.75f * a + 0.25f * b, 1e-5f);
      EXPECT_NEAR(change.at(x, y + 12.0f), 0.25f * a + 0.75f * c, 1e-5f);
      EXPECT_NEAR(change.at(x + 8.0f, y + 8.0f), 0.25f * (a + b + c + d), 1e-5f);
    }
  }
  EXPECT_EQ(change.at(-50.0f, 20.0f), change.at(7.5f, 20.0f));
  EXPECT_EQ(change.at(500.0f, 20.0f), change.at(87.5f, 20.0f));
  EXPECT_EQ(change.at(30.0f, -50.0f), change.at(30.0f, 7.5f));
  EXPECT_EQ(change.at(30.0f, 500.0f), change.at(30.0f, 55.5f));
}

}  // namespace
}  // namespace eigenlight
