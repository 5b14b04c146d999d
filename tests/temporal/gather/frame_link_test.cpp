#include "temporal/gather/frame_link.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <limits>

namespace eigenlight {
namespace {

constexpr Extent kExtent{40, 30};

// A wall at depth 4 that faces the camera, and does not move.
FrameInput wall(float depth = 4.0f) {
  FrameInput frame;
  frame.index = 1;
  frame.previous_index = 0;
  frame.resize_input(kExtent);
  frame.surface.depth.fill(depth);
  frame.surface.normal[2].fill(-1.0f);
  for (auto& plane : frame.surface.albedo) plane.fill(0.5f);
  frame.surface.id.fill(1);
  frame.previous_depth.fill(depth);
  return frame;
}

FrameInput moved_wall(float x, float y) {
  FrameInput frame = wall();
  frame.motion[0].fill(x);
  frame.motion[1].fill(y);
  return frame;
}

// The camera comes closer by `zoom`: what is seen at p was seen at center + (p - center) / zoom.
FrameInput zoomed_wall(float zoom) {
  FrameInput frame = wall(4.0f / zoom);
  frame.previous_depth.fill(4.0f);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      frame.motion[0](x, y) = (static_cast<float>(x) - 19.5f) * (1.0f / zoom - 1.0f);
      frame.motion[1](x, y) = (static_cast<float>(y) - 14.5f) * (1.0f / zoom - 1.0f);
    }
  }
  return frame;
}

Plane<PackedGuide> packed(const FrameInput& frame) {
  Plane<PackedGuide> guides;
  pack_guides(frame, {}, guides);
  return guides;
}

FrameLink back_of(const FrameInput& frame) {
  FrameLink link;
  link_back(frame, link);
  return link;
}

FrameLink ahead_of(const FrameInput& before, const FrameInput& frame) {
  FrameLink link;
  LinkAhead().find(back_of(frame), packed(frame), packed(before), {}, link);
  return link;
}

void expect_unknown(const Link& link) {
  EXPECT_EQ(link.known, 0.0f);
  EXPECT_EQ(link.x, 0.0f);
  EXPECT_EQ(link.y, 0.0f);
  EXPECT_EQ(link.log_depth, 0.0f);
}

void expect_near(const Link& link, glm::vec3 wanted, float tolerance) {
  EXPECT_EQ(link.known, 1.0f);
  EXPECT_NEAR(link.x, wanted.x, tolerance);
  EXPECT_NEAR(link.y, wanted.y, tolerance);
  EXPECT_NEAR(link.log_depth, wanted.z, 1e-5f);
}

TEST(LinkBack, FollowsMotionAndDepth) {
  FrameInput frame = moved_wall(3.25f, -2.0f);
  frame.previous_depth.fill(5.0f);
  const FrameLink back = back_of(frame);
  EXPECT_EQ(back.extent(), kExtent);
  for (const glm::ivec2 p : {glm::ivec2(0, 0), glm::ivec2(20, 15), glm::ivec2(39, 29)}) {
    expect_near(back(p.x, p.y), {3.25f, -2.0f, std::log(5.0f / 4.0f)}, 0.0f);
  }
}

TEST(LinkBack, KnowsNothingOfNonsense) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  FrameInput frame = moved_wall(1.0f, 1.0f);
  frame.motion[0](1, 1) = kNan;
  frame.motion[1](2, 1) = -kInf;
  frame.previous_depth(3, 1) = kNan;
  frame.previous_depth(4, 1) = 0.0f;
  frame.previous_depth(5, 1) = -4.0f;
  frame.surface.depth(6, 1) = kInf;
  frame.surface.id(7, 1) = 0;
  frame.surface.depth(8, 1) = 0.0f;
  frame.surface.depth(9, 1) = frame.previous_depth(9, 1) = -4.0f;
  const FrameLink back = back_of(frame);
  for (int x = 1; x <= 9; ++x) expect_unknown(back(x, 1));
  EXPECT_EQ(back(0, 1).known, 1.0f);
  EXPECT_EQ(back(10, 1).known, 1.0f);
}

// As sources write it: depth infinite now and before.
TEST(LinkBack, SkyIsUnknown) {
  FrameInput frame = wall();
  frame.surface.id(5, 5) = 0;
  frame.surface.depth(5, 5) = std::numeric_limits<float>::infinity();
  frame.previous_depth(5, 5) = std::numeric_limits<float>::infinity();
  expect_unknown(back_of(frame)(5, 5));
}

TEST(Links, OfACutAreUnknown) {
  FrameInput frame = wall();
  frame.previous_index = -1;
  const FrameLink back = back_of(frame), ahead = ahead_of(wall(), frame);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      ASSERT_EQ(back(x, y).known, 0.0f);
      ASSERT_EQ(ahead(x, y).known, 0.0f);
    }
  }
}

// What left the picture is unknown, or (beside its edge) leads out of it.
void expect_ahead_of_slide(float dx, float dy) {
  const FrameLink ahead = ahead_of(wall(), moved_wall(dx, dy));
  int seen = 0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const float to_x = static_cast<float>(x) - dx, to_y = static_cast<float>(y) - dy;
      const float out = std::max({-to_x, to_x - 39.0f, -to_y, to_y - 29.0f});
      if (out <= 0.5f || ahead(x, y).known != 0.0f) expect_near(ahead(x, y), {-dx, -dy, 0}, 0.0f);
      if (out >= 2.0f) expect_unknown(ahead(x, y));
      seen += out <= 0.5f;
    }
  }
  EXPECT_GT(seen, 800);
}

TEST(LinkAhead, TurnsWholePixelsAround) { expect_ahead_of_slide(4.0f, -3.0f); }

TEST(LinkAhead, TurnsFractionsAround) {
  expect_ahead_of_slide(0.4f, 0.3f);
  expect_ahead_of_slide(-5.45f, 2.55f);
}

// Depths change with the zoom by more than a width of guides.
void expect_zoom_without_gaps(float zoom) {
  const FrameLink ahead = ahead_of(wall(), zoomed_wall(zoom));
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const float off_x = static_cast<float>(x) - 19.5f, off_y = static_cast<float>(y) - 14.5f;
      if (std::abs(off_x) * zoom > 19.0f || std::abs(off_y) * zoom > 14.0f) continue;
      SCOPED_TRACE(testing::Message() << zoom << ": " << x << ' ' << y);
      // Links of pixels up to a pixel and a half away.
      const float tolerance = 1.5f * std::abs(zoom - 1.0f) + 1e-4f;
      expect_near(ahead(x, y), {off_x * (zoom - 1.0f), off_y * (zoom - 1.0f), -std::log(zoom)},
                  tolerance);
    }
  }
}

TEST(LinkAhead, HasNoGapsInAZoom) {
  expect_zoom_without_gaps(1.2f);
  expect_zoom_without_gaps(2.0f);
  expect_zoom_without_gaps(0.7f);
}

// The closest of the pixels that come to one.
TEST(LinkAhead, TakesTheClosest) {
  FrameInput frame = wall();
  frame.motion[0].fill(100.0f);
  frame.motion[0](10, 10) = 5.3f;
  frame.motion[0](11, 10) = 4.1f;
  frame.motion[0](12, 10) = 2.8f;
  const FrameLink ahead = ahead_of(wall(), frame);
  expect_near(ahead(15, 10), {-4.1f, 0, 0}, 0.0f);
  // A gap takes its neighbor's; beyond it nothing is known.
  expect_near(ahead(16, 11), {-4.1f, 0, 0}, 0.0f);
  expect_unknown(ahead(17, 10));
}

// A board of 10 columns and another color goes 6 pixels to the right in front of the wall.
struct Occlusion {
  static void put_board(FrameInput& frame, int left) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = left; x < left + 10; ++x) {
        frame.surface.depth(x, y) = frame.previous_depth(x, y) = 2.0f;
        for (auto& plane : frame.surface.albedo) plane(x, y) = 0.1f;
        frame.motion[0](x, y) = -6.0f;
      }
    }
  }
  Occlusion() {
    put_board(before, 8);
    put_board(after, 14);
  }
  FrameInput before = wall(), after = wall();
};

TEST(LinkAhead, KnowsNothingOfHiddenPixels) {
  const Occlusion shot;
  const FrameLink ahead = ahead_of(shot.before, shot.after);
  const Plane<PackedGuide> before = packed(shot.before), after = packed(shot.after);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      SCOPED_TRACE(testing::Message() << x << ' ' << y);
      const bool is_board = x >= 8 && x < 18, is_hidden = x >= 18 && x < 24;
      if (is_board) expect_near(ahead(x, y), {6.0f, 0, 0}, 0.0f);
      if (!is_board && !is_hidden) expect_near(ahead(x, y), {0, 0, 0}, 0.0f);
      if (is_hidden && x < 23) expect_unknown(ahead(x, y));
    }
    // Beside what is seen a link may be filled in. It leads to the board, which is another surface.
    EXPECT_LT(guide_weight(before(23, y), after(23, y)), kLeastMatch);
  }
}

// What the board uncovers comes from behind it: the wall's link there leads to the board.
TEST(LinkAhead, RefusesOtherSurfaces) {
  const Occlusion shot;
  FrameInput after = wall();  // the board is gone
  const FrameLink ahead = ahead_of(shot.before, after);
  for (int x = 0; x < kExtent.width; ++x) {
    EXPECT_EQ(ahead(x, 12).known, x < 8 || x >= 18 ? 1.0f : 0.0f) << x;
  }
}

TEST(LinkAhead, ForgetsTheFramesBefore) {
  LinkAhead finder;
  FrameLink used, fresh;
  const FrameInput first = moved_wall(0.4f, 0.0f), second = moved_wall(-6.0f, 2.0f);
  finder.find(back_of(first), packed(first), packed(wall()), {}, used);
  finder.find(back_of(second), packed(second), packed(wall()), {}, used);
  LinkAhead().find(back_of(second), packed(second), packed(wall()), {}, fresh);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      ASSERT_EQ(used(x, y).known, fresh(x, y).known);
      ASSERT_EQ(used(x, y).x, fresh(x, y).x);
    }
  }
}

}  // namespace
}  // namespace eigenlight
