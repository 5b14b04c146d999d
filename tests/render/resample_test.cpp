// Samples of rendered frames: extra samples, non-finite samples and direct light.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
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

TEST(LiveSource, ResampleDrawsIndependentSamplesOfTheSameMean) {
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

// next() and resample() draw from one sequence: 8 samples and 24 more equal 32 drawn at once.
TEST(LiveSource, ResampleContinuesTheRandomSequence) {
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

TEST(LiveSource, NonFiniteSamplesAreLeftOutAndCounted) {
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

// Without direct light, all other planes keep their bits.
TEST(LiveSource, ZeroDirectSamplesCostNoRays) {
  const Scene scene = moving_scene();
  RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource with(scene, animation, o, {0, 1});
  o.direct_spp = 0;
  LiveSource without(scene, animation, o, {0, 1});
  const Frame a = nth(with, 1), b = nth(without, 1);
  EXPECT_LT(b.rays, a.rays - a.extent().pixels() / 2);
  EXPECT_EQ(test::mean(b.direct), glm::dvec3(0.0));
  EXPECT_TRUE(test::same_bits(a.lights[0].radiance, b.lights[0].radiance));
  EXPECT_TRUE(test::same_bits(a.emission, b.emission));
  EXPECT_TRUE(test::same_bits(a.motion, b.motion));
  Planes<3> out;
  EXPECT_THROW(without.picture({.mode = AntialiasMode::kLookup}, b, b.lights[0].radiance, out),
               std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
