#include "render/scene/opacity.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "render/scene/texture_pyramid.h"

namespace eigenlight {
namespace {

/// A texture with round holes of a few texels.
Texture dotted(Extent extent) {
  Texture texture{"dotted", extent, std::vector<std::uint8_t>(4 * extent.pixels(), 255)};
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const int dx = x % 16 - 8, dy = y % 16 - 8;
      const auto pixel = static_cast<std::size_t>(y * extent.width + x);
      texture.rgba[4 * pixel + 3] =
          static_cast<std::uint8_t>(std::min(255, 8 * (dx * dx + dy * dy)));
    }
  }
  return texture;
}

TEST(OpacityMap, AllPointsOfATriangleHaveItsOpacity) {
  const Texture texture = dotted({64, 48});
  const float cutoff = 0.5f;
  const OpacityMap map(texture, cutoff);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anywhere(-3.0f, 3.0f), near(-0.02f, 0.02f),
      unit(0.0f, 1.0f);
  int count[3] = {};
  for (int i = 0; i < 20000; ++i) {
    const glm::vec2 center(anywhere(random), anywhere(random));
    std::array<glm::vec2, 3> uv;
    for (glm::vec2& corner : uv) corner = center + glm::vec2(near(random), near(random));
    const Opacity opacity = map.classify(uv);
    ++count[static_cast<int>(opacity)];
    if (opacity == Opacity::kMixed) continue;
    for (int k = 0; k < 20; ++k) {
      float u = unit(random), v = unit(random);
      if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
      const float alpha = bilinear_alpha(texture, (1.0f - u - v) * uv[0] + u * uv[1] + v * uv[2]);
      EXPECT_EQ(alpha < cutoff, opacity == Opacity::kHole);
    }
  }
  for (const int n : count) EXPECT_GT(n, 20);
}

TEST(OpacityMap, RepeatingTrianglesCoverTheWholeTexture) {
  Texture texture{"plain", {8, 8}, std::vector<std::uint8_t>(256, 255)};
  const std::array<glm::vec2, 3> wide{{{0, 0}, {7, 0}, {0, 5}}};
  EXPECT_EQ(OpacityMap(texture, 0.5f).classify(wide), Opacity::kSolid);
  texture.rgba[4 * 63 + 3] = 0;
  EXPECT_EQ(OpacityMap(texture, 0.5f).classify(wide), Opacity::kMixed);
  for (std::size_t i = 0; i < 64; ++i) texture.rgba[4 * i + 3] = 0;
  EXPECT_EQ(OpacityMap(texture, 0.5f).classify(wide), Opacity::kHole);
}

TEST(OpacityMap, NonFiniteCoordinatesGiveMixed) {
  const Texture texture = dotted({16, 16});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {nan, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(OpacityMap(texture, 0.0f).classify({{{0, bad}, {0, 0}, {0, 0}}}), Opacity::kMixed);
  }
  EXPECT_NE(OpacityMap(texture, 0.5f).classify({{{1e30f, 0}, {0, 1}, {0, 0}}}), Opacity::kSolid);
}

}  // namespace
}  // namespace eigenlight
