// Motion vectors of rendered frames.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/live_source.h"
#include "tests/support/moving_room.h"

namespace eigenlight {
namespace {

using test::camera_at;
using test::FunctionAnimation;
using test::moving_animation;
using test::moving_scene;
using test::nth;
using test::small_options;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The known movement of plate and camera gives the previous position of each pixel's point.
TEST(LiveSource, MotionFollowsObjectAndCamera) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource source(scene, animation, o, {7, 10});
  const Frame frame = nth(source, 1);
  EXPECT_EQ(frame.previous_index, 7);
  const Camera previous = animation.state(7).camera;
  int plate = 0, rest = 0;
  for (int y = 0; y < o.extent.height; ++y) {
    for (int x = 0; x < o.extent.width; ++x) {
      const std::uint32_t id = frame.surface.id(x, y);
      if (id == 0) continue;
      glm::vec3 before;
      for (int c = 0; c < 3; ++c) before[c] = test::at(frame.position, c, x, y);
      if (id == 4) before -= 3.0f * glm::vec3(0.05f, 0.02f, -0.03f);
      ++(id == 4 ? plate : rest);
      const glm::vec3 view = previous.to_view(before);
      const glm::vec2 expected = previous.view_to_pixel(view);
      EXPECT_NEAR(static_cast<float>(x) + 0.5f + frame.motion[0](x, y), expected.x, 2e-3f);
      EXPECT_NEAR(static_cast<float>(y) + 0.5f + frame.motion[1](x, y), expected.y, 2e-3f);
      EXPECT_NEAR(frame.previous_depth(x, y), view.z, 1e-4f);
    }
  }
  EXPECT_GT(plate, 20);
  EXPECT_GT(rest, 100);
}

TEST(LiveSource, SkyMovesLikeADirectionAtInfinity) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const glm::mat4 plate(1.0f);
  const FunctionAnimation animation([&](int frame) {
    const float angle = 0.01f * static_cast<float>(frame);
    const glm::vec3 eye(static_cast<float>(frame), 5, 0);  // translation does not move the sky
    const glm::vec3 forward(std::sin(angle), 1.0f, std::cos(angle));
    return SceneState{
        look_at(eye, eye + forward, {0, 1, 0}, 60.0f, o.extent), scene.lights, {plate}};
  });
  LiveSource source(scene, animation, o, {1});
  const Frame frame = nth(source, 0);
  const Camera now = animation.state(1).camera, then = animation.state(0).camera;
  for (int x = 0; x < o.extent.width; x += 7) {
    ASSERT_EQ(frame.surface.id(x, 3), 0U);
    EXPECT_EQ(frame.surface.depth(x, 3), kInfinity);
    EXPECT_EQ(frame.previous_depth(x, 3), kInfinity);
    EXPECT_FLOAT_EQ(test::at(frame.emission, 1, x, 3), 0.5f);
    const glm::vec2 center(static_cast<float>(x) + 0.5f, 3.5f);
    const glm::vec3 direction = glm::transpose(now.world_to_view) * now.pixel_to_view(center);
    const glm::vec2 before = then.view_to_pixel(then.world_to_view * direction);
    EXPECT_NEAR(frame.motion[0](x, 3), before.x - center.x, 2e-3f);
    EXPECT_NEAR(frame.motion[1](x, 3), before.y - center.y, 2e-3f);
  }
}

// The camera has turned around: all points were behind it in the previous frame.
TEST(LiveSource, PointsBehindThePreviousCameraMoveOutOfTheImage) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation([&](int frame) {
    const glm::vec3 ahead(0, 0, frame == 0 ? -1.0f : 1.0f);
    return SceneState{look_at({0, 0, -2}, glm::vec3(0, 0, -2) + ahead, {0, 1, 0}, 60.0f, o.extent),
                      scene.lights,
                      {}};
  });
  LiveSource source(scene, animation, o, {0, 1});
  const Frame frame = nth(source, 1);
  for (int y = 0; y < o.extent.height; ++y) {
    for (int x = 0; x < o.extent.width; ++x) {
      EXPECT_LT(frame.motion[0](x, y), -1e5f);
      EXPECT_LT(frame.previous_depth(x, y), 0.0f);
    }
  }
}

TEST(LiveSource, FrameIsStaticWhileCameraAndObjectsStand) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation([&](int frame) {
    SceneState state{camera_at({frame >= 3 ? 0.1f : 0.0f, 0, -2}, o.extent), scene.lights, {}};
    const float place = frame >= 5 ? 0.1f : 0.0f;
    state.poses = {glm::translate(glm::mat4(1.0f), glm::vec3(place, 0, 0))};
    state.lights.sky = glm::vec3(static_cast<float>(frame));  // a change of light is no motion
    if (frame >= 7) state.lights.rects[0].center.x = 0.2f;
    return state;
  });
  LiveSource source(scene, animation, o, {0, 1, 2, 3, 4, 5, 6, 7, 8});
  const bool expected[] = {true, true, true, false, true, false, true, false, true};
  Frame frame;
  for (const bool is_static : expected) {
    ASSERT_TRUE(source.next(frame));
    EXPECT_EQ(frame.is_static, is_static) << "frame " << frame.index;
  }
}

}  // namespace
}  // namespace eigenlight
