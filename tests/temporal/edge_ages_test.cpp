#include "temporal/edge_ages.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "tests/reference/edge_ages.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

void shorten(const Frame& frame, const Plane<float>& samples, float longest, Plane<float>& age) {
  const TileGrid grid = stage_tiles(frame.extent());
  for (int i = 0; i < grid.count(); ++i) {
    shorten_edge_ages({frame, samples}, {}, longest, grid.tile(i), age);
  }
}

// A wall that faces the camera and moves by a pixel and a half a frame.
Frame wall(Extent extent) {
  Frame frame = make_random_frame({.extent = extent, .sky = false, .disturbed = false}, 2);
  frame.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
  frame.surface.id.fill(1);
  frame.surface.depth.fill(4.0f);
  for (std::size_t c = 0; c < 3; ++c) frame.surface.normal[c].fill(c == 2 ? -1.0f : 0.0f);
  frame.motion[0].fill(1.5f);
  frame.motion[1].fill(0.0f);
  return frame;
}

std::vector<glm::ivec2> shortened(const Frame& frame) {
  const Extent extent = frame.extent();
  Plane<float> age(extent), samples(extent);
  age.fill(40.0f);
  samples.fill(1.0f);
  shorten(frame, samples, 12.0f, age);
  std::vector<glm::ivec2> found;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      if (age(x, y) == 40.0f) continue;
      EXPECT_EQ(age(x, y), 12.0f);
      found.emplace_back(x, y);
    }
  }
  return found;
}

TEST(EdgeAges, AgreeWithTheTwinOnEveryTarget) {
  const FloatTrapsOff nan_is_meant;
  for (const Extent extent : kSweepExtents) {
    const Frame frame = make_random_frame({.extent = extent}, 2);
    const Plane<float> samples = random_plane(extent, 4, 1.0f, 20.0f);
    const Plane<float> before = random_plane(extent, 5, 0.0f, 64.0f);
    for_each_target([&] {
      Plane<float> age = before.clone();
      shorten(frame, samples, 12.0f, age);
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const reference::Edge twin = reference::edge(frame, {}, {x, y});
          if (twin.margin < 1e-5) continue;  // float noise of a dot product
          const float most = std::max(12.0f, samples(x, y)), old = before(x, y);
          ASSERT_EQ(age(x, y), twin.found ? std::min(old, most) : old) << x << ", " << y;
        }
      }
    });
  }
}

TEST(EdgeAges, AWallHasNoneNotEvenBesideTheImage) {
  for (const Extent extent : kSweepExtents) {
    for_each_target([&] { EXPECT_TRUE(shortened(wall(extent)).empty()); });
  }
}

TEST(EdgeAges, BothSidesOfAStepAreEdges) {
  Frame frame = wall({65, 17});
  for (int y = 0; y < 17; ++y) {
    for (int x = 16; x < 65; ++x) frame.surface.depth(x, y) = 4.2f;
  }
  for_each_target([&] {
    const auto found = shortened(frame);
    ASSERT_EQ(found.size(), 2U * 17U);
    for (const glm::ivec2 p : found) EXPECT_TRUE(p.x == 15 || p.x == 16);
  });
}

TEST(EdgeAges, ALonePixelOfAnotherObjectMarksItselfAndItsNeighbors) {
  Frame frame = wall({65, 17});
  frame.surface.id(0, 0) = 7;
  frame.surface.id(40, 9) = 7;
  for_each_target([&] { EXPECT_EQ(shortened(frame).size(), 3U + 5U); });
}

TEST(EdgeAges, WhatCameFromWholePixelsRemembers) {
  Frame frame = wall({65, 17});
  frame.surface.id(40, 9) = 7;
  for (const float motion : {1e-4f, -3.0f}) {
    frame.motion[0].fill(motion);
    for_each_target([&] { EXPECT_TRUE(shortened(frame).empty()); });
  }
}

}  // namespace
}  // namespace eigenlight
