// Lookup of indirect light at the most similar guide ray.
#include <gtest/gtest.h>

#include <limits>

#include "render/antialias/lookup.h"
#include "tests/reference/antialias.h"
#include "tests/support/guide_frame.h"

namespace eigenlight {
namespace {

using test::GuideFrame;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Lookup, LookupMatchesTheReference) {
  const Extent extent{13, 9};
  const GuideFrame guides = test::random_guides(extent, 5);
  int none = 0, moved = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const EyePoint eye = test::random_eye(extent, i);
    const auto found = most_similar_guide(guides.map(), eye);
    const auto wanted = reference::similar_guides(guides.map(), eye);
    ASSERT_EQ(found.has_value(), !wanted.empty()) << i;
    if (!found) {
      ++none;
      continue;
    }
    moved += *found != glm::ivec2(eye.pixel);
    // Float and double may order candidates of nearly equal similarity differently.
    const auto same = std::find_if(wanted.begin(), wanted.end(),
                                   [&](const auto& candidate) { return candidate.at == *found; });
    ASSERT_NE(same, wanted.end()) << i;
    EXPECT_NEAR(same->similarity, wanted.front().similarity, 1e-5) << i;
  }
  EXPECT_GT(none, 5);
  EXPECT_GT(moved, 1000);
}

TEST(Lookup, LookupPrefersTheSameSurface) {
  GuideFrame guides({4, 4});
  guides.set_all({2.0f, {0, 0, -1}, glm::vec3(0.1f)});
  for (int y = 0; y < 4; ++y) guides.set(2, y, {1.0f, {-1, 0, 0}, glm::vec3(0.9f)});
  // The guide ray of the pixel met the wall; the camera ray to its right met the pillar in front.
  EXPECT_EQ(most_similar_guide(guides.map(), {{1.9f, 1.5f}, 1.01f, {-1, 0, 0}})->x, 2);
  EXPECT_EQ(most_similar_guide(guides.map(), {{1.9f, 1.5f}, 2.0f, {0, 0, -1}})->x, 1);
  // A hit between wall and pillar.
  EXPECT_EQ(most_similar_guide(guides.map(), {{1.9f, 1.5f}, 1.4f, {-1, 0, 0}})->x, 2);
  EXPECT_EQ(most_similar_guide(guides.map(), {{1.9f, 1.5f}, 1.4f, {-0.8f, 0, -0.6f}})->x, 2);
}

// Whatever else is alike: an eye ray in the sun takes its light from a guide ray in the sun.
TEST(Lookup, LookupStaysOnItsSideOfAShadowsEdge) {
  GuideFrame guides({4, 4});
  guides.set_all({});
  Plane<std::uint8_t> sees_sun({4, 4});
  for (int y = 0; y < 4; ++y) sees_sun(2, y) = sees_sun(3, y) = 1;
  const auto column = [&](float x, std::uint8_t seen) {
    const SeenAlike alike{sees_sun, seen};
    return most_similar_guide(guides.map(), {{x, 1.5f}, 1.0f, {0, 0, -1}}, &alike);
  };
  EXPECT_EQ(column(1.9f, 1)->x, 2);
  EXPECT_EQ(column(1.9f, 0)->x, 1);
  EXPECT_EQ(column(2.1f, 0)->x, 1);
  EXPECT_EQ(column(2.1f, 1)->x, 2);
  EXPECT_FALSE(column(3.2f, 0));
}

TEST(Lookup, NearestPixelBreaksTies) {
  GuideFrame guides({4, 4});
  guides.set_all({});
  const GuideMap map = guides.map();
  EXPECT_EQ(*most_similar_guide(map, {{1.6f, 1.6f}, 1.0f, {0, 0, -1}}), glm::ivec2(1, 1));
  EXPECT_EQ(*most_similar_guide(map, {{2.1f, 1.6f}, 1.0f, {0, 0, -1}}), glm::ivec2(2, 1));
  EXPECT_EQ(*most_similar_guide(map, {{1.6f, 2.9f}, 5.0f, {0, 1, 0}}), glm::ivec2(1, 2));
  EXPECT_EQ(*most_similar_guide(map, {{2.0f, 2.0f}, 1.0f, {0, 0, -1}}), glm::ivec2(1, 1));
}

TEST(Lookup, LookupStaysInsideTheImage) {
  GuideFrame guides({1, 1});
  guides.set_all({});
  for (const glm::vec2 pixel : {glm::vec2(0.0f), {0.99f, 0.01f}, {0.2f, 0.9f}, {0.5f, 0.5f}}) {
    EXPECT_EQ(*most_similar_guide(guides.map(), {pixel, 7.0f, {0, 1, 0}}), glm::ivec2(0, 0));
  }
}

// The infinite depth of the sky would make all depth differences equal if it were a candidate.
TEST(Lookup, SkyIsNotACandidate) {
  GuideFrame guides({2, 2});
  guides.set(0, 1, {1.0f, {0, 0, -1}});
  guides.set(1, 1, {2.0f, {0, 0, -1}});
  EXPECT_EQ(*most_similar_guide(guides.map(), {{0.6f, 0.6f}, 1.9f, {0, 0, -1}}), glm::ivec2(1, 1));
  EXPECT_EQ(*most_similar_guide(guides.map(), {{1.4f, 0.6f}, 1.1f, {0, 0, -1}}), glm::ivec2(0, 1));
}

TEST(Lookup, ResultIsEmptyWithoutASurface) {
  GuideFrame guides({4, 4});
  EXPECT_FALSE(most_similar_guide(guides.map(), {{1.9f, 1.9f}, 1.0f, {0, 0, -1}}));
  guides.set(0, 0, {});
  EXPECT_FALSE(most_similar_guide(guides.map(), {{1.9f, 1.9f}, 1.0f, {0, 0, -1}}));
  EXPECT_TRUE(most_similar_guide(guides.map(), {{1.4f, 1.4f}, 1.0f, {0, 0, -1}}));
}

TEST(Lookup, PixelsOfNonFiniteLightAreSkipped) {
  GuideFrame guides({2, 1});
  guides.set(0, 0, {1.0f, {0, 0, -1}, {0.1f, kNan, 0.1f}});
  const EyePoint eye{{0.6f, 0.5f}, 1.0f, {0, 0, -1}};
  EXPECT_FALSE(most_similar_guide(guides.map(), eye));
  guides.set(1, 0, {3.0f, {0, 1, 0}});
  EXPECT_EQ(*most_similar_guide(guides.map(), eye), glm::ivec2(1, 0));
}

}  // namespace
}  // namespace eigenlight
