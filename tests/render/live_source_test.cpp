// Rendered sequences: order, repeatability and options.
#include "render/live_source.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "frame/tiles.h"
#include "tests/support/moving_room.h"

namespace eigenlight {
namespace {

using test::camera_at;
using test::FunctionAnimation;
using test::moving_animation;
using test::moving_scene;
using test::nth;
using test::small_options;

TEST(LiveSource, ThreadCountDoesNotChangeTheBits) {
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
  test::expect_same(a, b);
}

TEST(LiveSource, FrameDoesNotDependOnFramesRenderedBefore) {
  const Scene scene = moving_scene();
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource all(scene, animation, o, {0, 1, 2, 3});
  LiveSource resumed(scene, animation, o, {0, 1, 2, 3}, 3);
  const Frame a = nth(all, 3);
  const Frame b = nth(resumed, 0);
  EXPECT_EQ(b.index, 3);
  EXPECT_EQ(b.previous_index, 2);
  test::expect_same(a, b);
}

TEST(LiveSource, NoiseDiffersBetweenFramesAndSeeds) {
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

TEST(LiveSource, NegativeFramesRenderLikeOthers) {
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
  // The same positions under another frame number: only the noise differs.
  const Frame other = nth(shifted, 0);
  EXPECT_TRUE(test::same_bits(last_negative.motion, other.motion));
  EXPECT_TRUE(test::same_bits(last_negative.surface.normal, other.surface.normal));
  EXPECT_FALSE(test::same_bits(last_negative.lights[0].radiance, other.lights[0].radiance));
  test::expect_same(nth(source, 0), nth(alone, 0));
  EXPECT_THROW(LiveSource(scene, animation, o, {std::numeric_limits<int>::min()}),
               std::invalid_argument);
}

TEST(LiveSource, SourceEndsAfterTheLastFrame) {
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

TEST(LiveSource, ErrorNamesTheBadOption) {
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
