// Frames: motion, repeatability, resampling, counters.
#include "render/live_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "frame/tiles.h"
#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using test::add_floor;
using test::add_material;
using test::FunctionAnimation;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

RenderOptions small_options() {
  RenderOptions o;
  o.extent = {40, 24};
  o.spp = 2;
  o.direct_spp = 2;
  return o;
}

/// A room without a front, a lamp, and a plate that moves as the frames go by.
Scene moving_scene() {
  Scene scene;
  add_material(scene, {0.7f, 0.6f, 0.5f});
  add_material(scene, {0.2f, 0.8f, 0.3f});
  add_floor(scene, 0, 3.0f, -1.0f);
  add_floor(scene, 0, 3.0f, 1.0f);
  test::add_quad(scene, 0, {glm::vec3(-3, -1, 3), glm::vec3(6, 0, 0), glm::vec3(0, 1.5f, 0)});
  test::add_quad(scene, 1,
                 {glm::vec3(-0.4f, -0.4f, 0), glm::vec3(0.8f, 0, 0), glm::vec3(0, 0.8f, 0)});
  scene.lights.sky = glm::vec3(0.5f);
  scene.lights.rects = {{{0, 0.9f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, {3, 3, 3}}};
  return scene;
}

Camera camera_at(const glm::vec3& eye, Extent extent) {
  return look_at(eye, eye + glm::vec3(0, 0, 1), {0, 1, 0}, 60.0f, extent);
}

FunctionAnimation moving_animation(const Scene& scene, Extent extent) {
  return FunctionAnimation([lights = scene.lights, extent](int frame) {
    const auto t = static_cast<float>(frame);
    const glm::vec3 place(0.05f * t, 0.02f * t, 1.0f - 0.03f * t);
    return SceneState{
        camera_at({0.04f * t, 0, -2}, extent), lights, {glm::translate(glm::mat4(1.0f), place)}};
  });
}

Frame nth(LiveSource& source, int n) {
  Frame frame;
  for (int i = 0; i <= n; ++i) {
    if (!source.next(frame)) throw std::logic_error("sequence too short");
  }
  return frame;
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_TRUE(test::same_bits(a.lights[0].radiance, b.lights[0].radiance));
  EXPECT_TRUE(test::same_bits(a.direct, b.direct));
  EXPECT_TRUE(test::same_bits(a.emission, b.emission));
  EXPECT_TRUE(test::same_bits(a.motion, b.motion));
  EXPECT_TRUE(test::same_bits(a.surface.albedo, b.surface.albedo));
  EXPECT_TRUE(test::same_bits(a.surface.normal, b.surface.normal));
  EXPECT_EQ(a.rays, b.rays);
}

TEST(LiveSource, SameBitsForOneAndTwoThreads) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  set_thread_count(1);
  LiveSource one(scene, animation, o, {0, 1, 2});
  const Frame a = nth(one, 2);
  set_thread_count(2);
  LiveSource two(scene, animation, o, {0, 1, 2});
  const Frame b = nth(two, 2);
  set_thread_count(0);
  expect_same(a, b);
}

TEST(LiveSource, AFrameDoesNotDependOnThoseRenderedBefore) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource all(scene, animation, o, {0, 1, 2, 3});
  LiveSource resumed(scene, animation, o, {0, 1, 2, 3}, 3);
  const Frame a = nth(all, 3);
  const Frame b = nth(resumed, 0);
  EXPECT_EQ(b.index, 3);
  EXPECT_EQ(b.previous_index, 2);
  expect_same(a, b);
}

TEST(LiveSource, FramesAndSeedsAreIndependent) {
  const Scene scene = moving_scene();
  RenderOptions o = small_options();
  const FunctionAnimation animation([&](int) {
    return SceneState{camera_at({0, 0, -2}, o.extent), scene.lights, {}};
  });
  LiveSource source(scene, animation, o, {0, 1});
  const Frame first = nth(source, 0);
  const Frame second = nth(source, 0);
  EXPECT_FALSE(test::same_bits(first.lights[0].radiance, second.lights[0].radiance));
  EXPECT_TRUE(test::same_bits(first.surface.normal, second.surface.normal));
  o.seed = 1;
  LiveSource other(scene, animation, o, {0});
  EXPECT_FALSE(test::same_bits(first.lights[0].radiance, nth(other, 0).lights[0].radiance));
}

TEST(LiveSource, NegativeFramesAreFramesLikeOthers) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  const FunctionAnimation later([&](int frame) { return animation.state(frame - 12); });
  LiveSource source(scene, animation, o, {-10, -2, -1, 0, 1});
  LiveSource alone(scene, animation, o, {0});
  LiveSource shifted(scene, later, o, {11});
  const Frame first = nth(source, 0);
  EXPECT_EQ(first.previous_index, -11);
  const Frame last_negative = nth(source, 1);
  EXPECT_EQ(last_negative.index, -1);
  EXPECT_EQ(last_negative.previous_index, -2);
  // The same places under another number: only the noise differs.
  const Frame other = nth(shifted, 0);
  EXPECT_TRUE(test::same_bits(last_negative.motion, other.motion));
  EXPECT_TRUE(test::same_bits(last_negative.surface.normal, other.surface.normal));
  EXPECT_FALSE(test::same_bits(last_negative.lights[0].radiance, other.lights[0].radiance));
  expect_same(nth(source, 0), nth(alone, 0));
  EXPECT_THROW(LiveSource(scene, animation, o, {std::numeric_limits<int>::min()}),
               std::invalid_argument);
}

TEST(LiveSource, EndsAfterTheLastFrame) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource source(scene, animation, o, {4});
  Frame frame;
  EXPECT_TRUE(source.next(frame));
  EXPECT_EQ(frame.index, 4);
  EXPECT_EQ(frame.previous_index, 3);
  EXPECT_FALSE(source.next(frame));
}

// Where each pixel's point was follows from the known movement of the plate and the camera alone.
TEST(LiveSource, MotionOfMovingObjectAndCameraIsExact) {
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

TEST(LiveSource, SkyMovesAsADirectionAtInfinity) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const glm::mat4 plate(1.0f);
  const FunctionAnimation animation([&](int frame) {
    const float angle = 0.01f * static_cast<float>(frame);
    const glm::vec3 eye(static_cast<float>(frame), 5, 0);  // travel must not matter
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

// The camera has turned round: everything was behind it.
TEST(LiveSource, PointsBehindThePreviousCameraLeadOutOfTheImage) {
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

TEST(LiveSource, IsStaticOnlyWhileCameraAndObjectsStand) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation([&](int frame) {
    SceneState state{camera_at({frame >= 3 ? 0.1f : 0.0f, 0, -2}, o.extent), scene.lights, {}};
    const float place = frame >= 5 ? 0.1f : 0.0f;
    state.poses = {glm::translate(glm::mat4(1.0f), glm::vec3(place, 0, 0))};
    state.lights.sky = glm::vec3(static_cast<float>(frame));  // light alone moves nothing
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

TEST(LiveSource, ResampleAddsIndependentSamplesOfTheSameMean) {
  const Scene scene = moving_scene();
  RenderOptions o = small_options();
  o.spp = 32;
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource source(scene, animation, o, {0});
  Frame frame = nth(source, 0);
  const std::int64_t rays = frame.rays;
  Plane<std::uint8_t> extra(o.extent);
  extra.fill(32);
  extra(5, 5) = 0;
  Planes<3> first, second;
  ASSERT_TRUE(resample(source, extra, frame, first));
  EXPECT_GT(frame.rays, rays + 32 * 100);
  ASSERT_TRUE(resample(source, extra, frame, second));
  const double expected = test::mean(frame.lights[0].radiance).x;
  ASSERT_GT(expected, 0.1);
  EXPECT_NEAR(test::mean(first).x, expected, 0.02 * expected);
  EXPECT_NEAR(test::mean(second).x, expected, 0.02 * expected);
  EXPECT_FALSE(test::same_bits(first, frame.lights[0].radiance));
  EXPECT_FALSE(test::same_bits(first, second));
  EXPECT_EQ(first[0](5, 5), 0.0f);
}

// Samples of next() and resample() are one sequence: 8 and 24 more are the 32 of a source that
// draws 32 at once.
TEST(LiveSource, ResampleContinuesTheSequenceOfThePixel) {
  const Scene scene = moving_scene();
  RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  o.spp = 32;
  LiveSource whole(scene, animation, o, {0});
  const Frame all = nth(whole, 0);
  o.spp = 8;
  LiveSource parts(scene, animation, o, {0});
  Frame part = nth(parts, 0);
  Plane<std::uint8_t> extra(o.extent);
  extra.fill(24);
  Planes<3> more;
  ASSERT_TRUE(resample(parts, extra, part, more));
  for (int x = 0; x < o.extent.width; ++x) {
    const float sum = (8.0f * part.lights[0].radiance[0](x, 12) + 24.0f * more[0](x, 12)) / 32.0f;
    EXPECT_NEAR(sum, all.lights[0].radiance[0](x, 12), 1e-5f);
  }
}

TEST(LiveSource, NonFiniteSamplesAreCountedAndLeftOut) {
  const FloatTrapsOff nan_is_meant;
  Scene scene = moving_scene();
  scene.lights.spheres = {{{0, 0, -5}, 0.5f, {kInfinity, 1, 1}}};  // behind the camera
  const RenderOptions o = small_options();
  const Frame frame = test::render_still(scene, camera_at({0, 0, -2}, o.extent), o);
  EXPECT_GT(frame.non_finite_samples, 0);
  int unknown = 0;
  for (int y = 0; y < o.extent.height; ++y) {
    for (int x = 0; x < o.extent.width; ++x) {
      const float value = frame.lights[0].radiance[0](x, y);
      EXPECT_FALSE(std::isinf(value));
      if (std::isnan(value)) ++unknown;
    }
  }
  EXPECT_LT(unknown, static_cast<int>(o.extent.pixels()));
}

// Who does not look at direct light does not pay for it, and gets the same of all else.
TEST(LiveSource, DirectLightThatNobodyWantsCostsNoRays) {
  const Scene scene = moving_scene();
  RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource with(scene, animation, o, {0, 1});
  o.direct_spp = 0;
  LiveSource without(scene, animation, o, {0, 1});
  const Frame a = nth(with, 1), b = nth(without, 1);
  EXPECT_LT(b.rays, a.rays - a.extent().pixels());
  EXPECT_EQ(test::mean(b.direct), glm::dvec3(0.0));
  EXPECT_TRUE(test::same_bits(a.lights[0].radiance, b.lights[0].radiance));
  EXPECT_TRUE(test::same_bits(a.emission, b.emission));
  EXPECT_TRUE(test::same_bits(a.motion, b.motion));
  Planes<3> out;
  EXPECT_THROW(without.picture({.mode = AntialiasMode::kLookup}, b, b.lights[0].radiance, out),
               std::invalid_argument);
}

TEST(LiveSource, BadOptionsAreNamed) {
  const auto message = [](const RenderOptions& o) -> std::string {
    try {
      o.validate();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  RenderOptions o;
  EXPECT_EQ(message(o), "");
  o.spp = 0;
  EXPECT_EQ(message(o), "spp 0: expected 1 to 65536");
  o = {};
  o.bounces = 65;
  EXPECT_EQ(message(o), "bounces 65: expected 1 to 64");
  o = {};
  o.direct_spp = -1;
  EXPECT_EQ(message(o), "direct_spp -1: expected 0 to 65536");
}

}  // namespace
}  // namespace eigenlight
