#include "frame/usable_surface.h"

#include <gtest/gtest.h>

#include <limits>

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

GBuffer wall() {
  GBuffer surface;
  surface.resize({1, 1});
  surface.id(0, 0) = 1;
  surface.depth(0, 0) = 2.0f;
  surface.normal[2](0, 0) = -1.0f;
  return surface;
}

TEST(UsableSurface, NeedsIdDepthAndNormal) {
  GBuffer surface = wall();
  EXPECT_TRUE(is_usable_surface(surface, 0, 0));
  surface.id(0, 0) = 0;
  EXPECT_FALSE(is_usable_surface(surface, 0, 0));
}

// No traps are turned off here: NaN must be no floating-point fault.
TEST(UsableSurface, RejectsDepthsWhoseSquareOverflows) {
  for (const float depth : {kNan, kInfinity, -kInfinity, -3.0f, 0.0f, 1e-40f, 1e30f}) {
    GBuffer surface = wall();
    surface.depth(0, 0) = depth;
    EXPECT_FALSE(is_usable_surface(surface, 0, 0)) << depth;
  }
  for (const float depth : {kNearestDepth, 1e-3f, 1e6f, kFarthestDepth}) {
    GBuffer surface = wall();
    surface.depth(0, 0) = depth;
    EXPECT_TRUE(is_usable_surface(surface, 0, 0)) << depth;
  }
}

TEST(UsableSurface, RejectsInvalidNormals) {
  for (const float component : {kNan, kInfinity, -3.0f, 1e30f}) {
    GBuffer surface = wall();
    surface.normal[1](0, 0) = component;
    EXPECT_FALSE(is_usable_surface(surface, 0, 0)) << component;
  }
  // As half floats round it.
  GBuffer surface = wall();
  surface.normal[2](0, 0) = -1.0005f;
  EXPECT_TRUE(is_usable_surface(surface, 0, 0));
}

}  // namespace
}  // namespace eigenlight
