// What the guided filter does to light.
#include "spatial/guided_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/spatial/guided_case.h"

namespace eigenlight {
namespace {

using test::distance;
using test::GuidedCase;
using test::random;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Box and wall have the same normal and differ in depth only.
TEST(GuidedFilter, DepthGuidesOnlyWithNormalDepth) {
  GuidedCase c({96, 64});
  c.flat_wall();
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 48; ++x) {
      c.frame.surface.depth(x, y) = 2.0f;
      for (auto& plane : c.signal) plane(x, y) = 3.0f;
    }
    for (int x = 48; x < 96; ++x) {
      for (auto& plane : c.signal) plane(x, y) = 1.0f;
    }
  }
  EXPECT_GT(c.filter()[0](47, 32), 2.8f);
  EXPECT_NEAR(c.filter({.guides = Guides::kNormal})[0](47, 32), 2.0f, 0.1f);
}

TEST(GuidedFilter, PixelsOfZeroWeightHaveNoInfluence) {
  GuidedCase clean({100, 70});
  GuidedCase dirty({100, 70});
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 100; ++x) {
      const float bad[5] = {kNan, kInf, -kInf, 3e38f, -1e30f};
      const auto pick = static_cast<std::size_t>(5.0f * random(x, y, 50));
      if (clean.weight(x, y) == 0.0f) dirty.signal[pick % 3](x, y) = bad[pick];
      if (clean.frame.surface.id(x, y) == 0) {
        dirty.frame.surface.normal[1](x, y) = kNan;
        dirty.weight(x, y) = 7.0f;
      }
    }
  }
  EXPECT_EQ(distance(clean.filter(), dirty.filter()), 0.0);
}

TEST(GuidedFilter, NonFiniteLightCountsAsMissing) {
  GuidedCase missing({70, 40});
  missing.flat_wall();
  missing.weight(33, 20) = 0.0f;
  GuidedCase broken({70, 40});
  broken.flat_wall();
  broken.signal[1](33, 20) = kNan;
  const Planes<3> out = broken.filter();
  EXPECT_EQ(distance(missing.filter(), out), 0.0);
  EXPECT_GT(out[1](33, 20), 0.0f);
}

TEST(GuidedFilter, ConstantLightStaysConstant) {
  GuidedCase c({130, 70});
  for (auto& plane : c.signal) plane.fill(2.5f);
  const Planes<3> out = c.filter();
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 130; ++x) {
      const bool surface = c.frame.surface.id(x, y) != 0;
      ASSERT_NEAR(out[0](x, y), surface ? 2.5f : 0.0f, 1e-5f) << x << ", " << y;
    }
  }
}

TEST(GuidedFilter, FireflyAffectsItsWindowsOnly) {
  GuidedCase c({150, 60});
  c.flat_wall();
  for (auto& plane : c.signal) plane.fill(1.0f);
  c.signal[0](70, 30) = 1e9f;
  const GuidedOptions options{.radius = 4};
  const Planes<3> out = c.filter(options);
  EXPECT_GT(out[0](70, 30), 1e5f);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 150; ++x) {
      if (std::abs(x - 70) > 8 || std::abs(y - 30) > 8) {
        ASSERT_NEAR(out[0](x, y), 1.0f, 1e-6f);
      }
    }
  }
}

// Light that differs between two walls follows the edge of the normals, and the noise on each wall
// falls by what 17 x 17 pixels give.
TEST(GuidedFilter, NormalEdgeIsKeptAndNoiseFalls) {
  GuidedCase c({128, 96});
  c.flat_wall();
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) {
      const bool left = x < 64;
      c.frame.surface.normal[0](x, y) = left ? 1.0f : 0.0f;
      c.frame.surface.normal[2](x, y) = left ? 0.0f : 1.0f;
      for (auto& plane : c.signal) {
        plane(x, y) = (left ? 2.0f : 1.0f) * (0.5f + random(x, y, 9));
      }
    }
  }
  const Planes<3> out = c.filter();
  double error = 0.0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) error += std::pow((out[0](x, y) - (x < 64 ? 2.0 : 1.0)), 2);
    EXPECT_GT(out[0](63, y), 1.85f);
    EXPECT_LT(out[0](64, y), 1.15f);
  }
  // Variance of the noise is 4 / 12 and 1 / 12.
  EXPECT_LT(error / (96.0 * 128.0), 0.01 * (5.0 / 24.0));
}

TEST(GuidedFilter, KeepsTheMeanOfLight) {
  GuidedCase c({128, 128});
  c.flat_wall();
  const Planes<3> out = c.filter();
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      before += static_cast<double>(c.signal[1](x, y));
      after += static_cast<double>(out[1](x, y));
    }
  }
  EXPECT_NEAR(after / before, 1.0, 0.01);
}

TEST(GuidedFilter, HeavyPixelsDominate) {
  GuidedCase c({40, 40});
  c.flat_wall();
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool old = (x + y) % 2 == 0;
      c.weight(x, y) = old ? 30.0f : 1.0f;
      for (auto& plane : c.signal) plane(x, y) = old ? 1.0f : 32.0f;
    }
  }
  // Means of windows with one pixel more of one kind: (30 * 145 + 32 * 144) / (30 * 145 + 144).
  EXPECT_NEAR(c.filter()[0](20, 20), 2.0f, 0.02f);
}

TEST(GuidedFilter, ResultIsZeroWithoutUsablePixels) {
  GuidedCase c({20, 20});
  c.weight.fill(0.0f);
  for (auto& plane : c.signal) plane.fill(kNan);
  const Planes<3> out = c.filter();
  EXPECT_EQ(distance(out, make_planes<3>(c.extent)), 0.0);
}

}  // namespace
}  // namespace eigenlight
