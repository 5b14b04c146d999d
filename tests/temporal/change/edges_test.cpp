#include "temporal/change/edges.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "tests/reference/edges.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

Plane<std::uint8_t> edges(const Frame& frame) {
  Plane<std::uint8_t> edge(frame.extent());
  edge.fill(7);
  for_each_tile(stage_tiles(frame.extent()),
                [&](const Rect& tile) { find_edges(frame, {}, tile, edge); });
  return edge;
}

// A wall that faces the camera and moves by 1.5 pixels per frame.
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

std::vector<glm::ivec2> found(const Frame& frame) {
  const Plane<std::uint8_t> edge = edges(frame);
  std::vector<glm::ivec2> found;
  for (int y = 0; y < edge.height(); ++y) {
    for (int x = 0; x < edge.width(); ++x) {
      if (edge(x, y) == 0) continue;
      EXPECT_EQ(edge(x, y), 1);
      found.emplace_back(x, y);
    }
  }
  return found;
}

EL_KERNEL_TEST(Edges, MatchTheReference) {
  const FloatTrapsOff nan_is_meant;
  const Frame frame = make_random_frame({.extent = extent}, 2);
  on_every_target([&] {
    const Plane<std::uint8_t> edge = edges(frame);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const reference::Edge twin = reference::edge(frame, {}, {x, y});
        if (twin.margin < 1e-5) continue;  // float noise of a dot product
        ASSERT_EQ(edge(x, y), twin.found ? 1 : 0) << x << ", " << y;
      }
    }
  });
}

EL_KERNEL_TEST(ShortenAges, MatchesTheReference) {
  const Plane<float> samples = random_plane(extent, 4, 1.0f, 30.0f);
  const Plane<float> before = random_plane(extent, 5, 0.0f, 64.0f);
  Plane<std::uint8_t> edge(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) edge(x, y) = PixelRandom(6, x, y).uniform() < 0.3f;
  }
  on_every_target([&] {
    Plane<float> age = before.clone();
    for_each_tile(stage_tiles(extent), [&](const Rect& tile) {
      shorten_ages(edge, samples, {18.0f, 12.0f}, tile, age);
    });
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const double longest = edge(x, y) != 0 ? 12.0 : 18.0;
        ASSERT_EQ(age(x, y), reference::shortened_age(before(x, y), samples(x, y), longest))
            << x << ", " << y;
      }
    }
  });
}

EL_KERNEL_TEST(Edges, WallHasNoEdges) {
  on_every_target([&] { EXPECT_TRUE(found(wall(extent)).empty()); });
}

TEST(Edges, BothSidesOfAStepAreEdges) {
  Frame frame = wall({65, 17});
  for (int y = 0; y < 17; ++y) {
    for (int x = 16; x < 65; ++x) frame.surface.depth(x, y) = 4.2f;
  }
  for_each_target([&] {
    const auto pixels = found(frame);
    ASSERT_EQ(pixels.size(), 2U * 17U);
    for (const glm::ivec2 p : pixels) EXPECT_TRUE(p.x == 15 || p.x == 16);
  });
}

TEST(Edges, PixelOfAnotherObjectMarksItselfAndItsNeighbors) {
  Frame frame = wall({65, 17});
  frame.surface.id(0, 0) = 7;
  frame.surface.id(40, 9) = 7;
  for_each_target([&] { EXPECT_EQ(found(frame).size(), 3U + 5U); });
}

TEST(Edges, MotionByWholePixelsHasNoEdges) {
  Frame frame = wall({65, 17});
  frame.surface.id(40, 9) = 7;
  for (const float motion : {1e-4f, -3.0f}) {
    frame.motion[0].fill(motion);
    for_each_target([&] { EXPECT_TRUE(found(frame).empty()); });
  }
}

}  // namespace
}  // namespace eigenlight
