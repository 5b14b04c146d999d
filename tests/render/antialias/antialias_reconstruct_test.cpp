// Reconstruction of light at a camera ray from the guide rays around it.
#include <gtest/gtest.h>

#include <limits>

#include "render/antialias/reconstruct.h"
#include "tests/reference/antialias.h"
#include "tests/support/guide_frame.h"

namespace eigenlight {
namespace {

using test::GuideFrame;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr glm::vec3 kBack{0, 0, -1};

TEST(Reconstruct, ReconstructionMatchesTheReference) {
  const Extent extent{13, 9};
  const GuideFrame guides = test::random_guides(extent, 6);
  Plane<std::uint8_t> lit(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) lit(x, y) = hash_key(3u, x, y) % 4 == 0 ? 1 : 3;
  }
  int none = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const EyePoint eye = test::random_eye(extent, i);
    const auto found = reconstruct_light(guides.map(), lit, eye, i % 4 == 0 ? 1 : 3);
    const auto wanted = reference::reconstruct_light(guides.map(), lit, eye, i % 4 == 0 ? 1 : 3);
    ASSERT_EQ(found.has_value(), wanted.has_value()) << i;
    none += !found;
    if (!found) continue;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR((*found)[c], (*wanted)[c], 2e-5) << i;
  }
  EXPECT_GT(none, 100);
  EXPECT_LT(none, 3900);
}

// One surface of constant light keeps that light at every position in the image.
TEST(Reconstruct, ConstantLightStaysConstant) {
  const Extent extent{5, 4};
  GuideFrame guides(extent);
  guides.set_all({3.0f, kBack, glm::vec3(0.3f, 0.1f, 0.7f), glm::vec3(0.5f)});
  const Plane<std::uint8_t> lit(extent);
  for (std::uint32_t i = 0; i < 200; ++i) {
    EyePoint eye = test::random_eye(extent, i);
    eye.depth = 3.0f;
    eye.normal = kBack;
    const auto light = reconstruct_light(guides.map(), lit, eye, 0);
    ASSERT_TRUE(light);
    EXPECT_FLOAT_EQ(light->x, 0.8f);
    EXPECT_FLOAT_EQ(light->y, 0.6f);
    EXPECT_FLOAT_EQ(light->z, 1.2f);
  }
}

TEST(Reconstruct, LightDoesNotCrossAnEdge) {
  GuideFrame guides({4, 4});
  guides.set_all({2.0f, kBack, glm::vec3(0.1f)});
  for (int y = 0; y < 4; ++y) guides.set(2, y, {1.0f, kBack, glm::vec3(0.9f)});
  const Plane<std::uint8_t> lit({4, 4});
  EXPECT_NEAR(reconstruct_light(guides.map(), lit, {{2.0f, 1.5f}, 1.0f, kBack}, 0)->x, 0.9f, 1e-6f);
  EXPECT_NEAR(reconstruct_light(guides.map(), lit, {{2.0f, 1.5f}, 2.0f, kBack}, 0)->x, 0.1f, 1e-6f);
}

TEST(Reconstruct, LightDoesNotCrossAShadowEdge) {
  GuideFrame guides({4, 4});
  guides.set_all({2.0f, kBack, glm::vec3(0.0f), glm::vec3(4.0f)});
  Plane<std::uint8_t> lit({4, 4});
  lit.fill(1);
  for (int y = 0; y < 4; ++y) {
    guides.set(1, y, {2.0f, kBack, glm::vec3(0.0f), glm::vec3(0.0f)});
    lit(1, y) = 0;
  }
  EXPECT_EQ(reconstruct_light(guides.map(), lit, {{1.9f, 1.6f}, 2.0f, kBack}, 1)->x, 4.0f);
  EXPECT_EQ(reconstruct_light(guides.map(), lit, {{1.9f, 1.6f}, 2.0f, kBack}, 0)->x, 0.0f);
}

TEST(Reconstruct, NonFiniteLightDoesNotSpread) {
  GuideFrame guides({3, 3});
  guides.set_all({1.0f, kBack, glm::vec3(0.5f)});
  guides.set(1, 1, {1.0f, kBack, glm::vec3(kNan)});
  guides.set(0, 1, {1.0f, kBack, glm::vec3(0.0f), glm::vec3(1.0f, kNan, 1.0f)});
  const Plane<std::uint8_t> lit({3, 3});
  for (const glm::vec2 pixel : {glm::vec2(1.2f, 1.2f), {1.9f, 1.4f}, {1.1f, 1.8f}}) {
    EXPECT_EQ(*reconstruct_light(guides.map(), lit, {pixel, 1.0f, kBack}, 0), glm::vec3(0.5f));
  }
}

TEST(Reconstruct, ResultIsEmptyWithoutASimilarNeighbor) {
  GuideFrame guides({3, 3});
  const Plane<std::uint8_t> lit({3, 3});
  const EyePoint eye{{1.4f, 1.6f}, 1.0f, kBack};
  EXPECT_FALSE(reconstruct_light(guides.map(), lit, eye, 0));  // all pixels show the sky
  guides.set_all({2.0f, kBack});
  EXPECT_FALSE(reconstruct_light(guides.map(), lit, eye, 0));  // far behind
  guides.set_all({1.0f, kBack});
  EXPECT_FALSE(reconstruct_light(guides.map(), lit, eye, 1));  // in the shadow
  EXPECT_TRUE(reconstruct_light(guides.map(), lit, eye, 0));
}

}  // namespace
}  // namespace eigenlight
