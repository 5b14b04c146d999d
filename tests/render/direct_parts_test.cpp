// The two parts of direct light: of suns, with more samples in penumbras, and of all else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/moving_room.h"

namespace eigenlight {
namespace {

using test::FunctionAnimation;
using test::moving_animation;
using test::moving_scene;
using test::nth;
using test::small_options;

constexpr Extent kExtent{64, 32};

// A floor, half of it in the shadow of a plate 2 above it, under a wide sun.
Scene shadow_scene() {
  Scene scene;
  const int gray = static_cast<int>(test::add_material(scene, {0.5f, 0.5f, 0.5f}));
  test::add_floor(scene, gray, 5.0f);
  test::add_quad(scene, gray, {glm::vec3(0, 2, -9), glm::vec3(9, 0, 0), glm::vec3(0, 0, 18)});
  scene.lights.suns = {{glm::vec3(0, 1, 0), {3.0f, 3.0f, 3.0f}, 4.0f}};
  return scene;
}

RenderOptions options_of(int direct_spp, int penumbra_spp, std::uint32_t seed = 0) {
  RenderOptions o;
  o.extent = kExtent;
  o.spp = 1;
  o.bounces = 1;
  o.direct_spp = direct_spp;
  o.penumbra_spp = penumbra_spp;
  o.seed = seed;
  return o;
}

struct Shadow {
  Frame frame;
  Planes<3> sun = make_planes<3>(kExtent);
};

Shadow render_shadow(const RenderOptions& options) {
  const Scene scene = shadow_scene();
  const FunctionAnimation animation = test::still(scene, test::camera_down(kExtent));
  LiveSource source(scene, animation, options, {0});
  Shadow shadow;
  EXPECT_TRUE(source.next(shadow.frame));
  copy_planes(source.sun(), shadow.sun);
  return shadow;
}

double squared_error(const Planes<3>& a, const Planes<3>& b) {
  double sum = 0.0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const auto d = static_cast<double>(a[0](x, y) - b[0](x, y));
      sum += d * d;
    }
  }
  return sum / static_cast<double>(kExtent.pixels());
}

TEST(DirectParts, AddUpToDirectLight) {
  Scene scene = moving_scene();
  scene.lights.suns = {{glm::normalize(glm::vec3(0.3f, 1, -1)), {3.0f, 2.0f, 1.0f}, 2.0f}};
  const RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  LiveSource source(scene, animation, o, {0, 1});
  const Frame frame = nth(source, 1);
  EXPECT_GT(test::mean(source.sun()).x, 0.01);
  EXPECT_GT(test::mean(source.soft()).x, 0.01);
  for (int y = 0; y < o.extent.height; ++y) {
    for (int x = 0; x < o.extent.width; ++x) {
      EXPECT_EQ(source.sun()[1](x, y) + source.soft()[1](x, y), frame.direct[1](x, y));
    }
  }
}

// A penumbra of 0.14 on a floor of 0.73 width: a fifth of the pixels.
TEST(DirectParts, PenumbrasGetMoreSamplesAndOtherPixelsNone) {
  const Shadow truth = render_shadow(options_of(1024, 0, 7));
  const Shadow plain = render_shadow(options_of(1, 0)), fine = render_shadow(options_of(1, 16));
  const std::int64_t extra = fine.frame.rays - plain.frame.rays;
  EXPECT_GT(extra, 15 * kExtent.pixels() / 10);
  EXPECT_LT(extra, 15 * kExtent.pixels() / 2);
  EXPECT_LT(squared_error(fine.sun, truth.sun), 0.1 * squared_error(plain.sun, truth.sun));
  // Off the penumbra one sample has no noise.
  for (int y = 0; y < kExtent.height; ++y) {
    for (const int x : {0, kExtent.width - 1}) {
      EXPECT_EQ(fine.sun[0](x, y), plain.sun[0](x, y));
      EXPECT_NEAR(fine.sun[0](x, y), truth.sun[0](x, y), 2e-3f);
    }
  }
}

// Means over columns and seeds: a test by a pixel's own samples alone would make penumbras steeper.
TEST(DirectParts, PenumbrasKeepTheirLight) {
  const Shadow truth = render_shadow(options_of(1024, 0, 7));
  for (int x0 = 0; x0 < kExtent.width; x0 += 8) {
    double light = 0.0, expected = 0.0;
    for (std::uint32_t seed = 0; seed < 16; ++seed) {
      const Shadow fine = render_shadow(options_of(1, 16, seed));
      for (int y = 0; y < kExtent.height; ++y) {
        for (int x = x0; x < x0 + 8; ++x) {
          light += static_cast<double>(fine.sun[0](x, y));
          expected += static_cast<double>(truth.sun[0](x, y));
        }
      }
    }
    EXPECT_NEAR(light, expected, 0.015 * std::max(expected, 16.0 * 256.0 * 0.1)) << x0;
  }
}

// The first rays of extra paths meet the sky and the lamp too.
TEST(DirectParts, SoftLightTakesTheRaysOfExtraSamplesIn) {
  Scene scene = moving_scene();
  scene.lights.rects.clear();
  RenderOptions o = small_options();
  const FunctionAnimation animation = moving_animation(scene, o.extent);
  o.spp = 512;
  o.direct_spp = 1;
  LiveSource many(scene, animation, o, {0});
  (void)nth(many, 0);
  o.spp = 2;
  LiveSource source(scene, animation, o, {0});
  Frame frame = nth(source, 0);
  Planes<3> first = make_planes<3>(o.extent), mean;
  copy_planes(source.soft(), first);
  const auto error = [&](const Planes<3>& light) {
    double sum = 0.0;
    for (int y = 0; y < o.extent.height; ++y) {
      for (int x = 0; x < o.extent.width; ++x) {
        const auto d = static_cast<double>(light[0](x, y) - many.soft()[0](x, y));
        sum += d * d;
      }
    }
    return sum;
  };
  Plane<std::uint8_t> extra(o.extent);
  extra.fill(30);
  ASSERT_TRUE(resample(source, extra, frame, mean));
  EXPECT_LT(error(source.soft()), 0.15 * error(first));
  EXPECT_NEAR(test::mean(source.soft()).x, test::mean(many.soft()).x,
              0.02 * test::mean(many.soft()).x);
  source.rewind_resampling();
  EXPECT_TRUE(test::same_bits(source.soft(), first));
}

TEST(DirectParts, NoSamplesGiveNoLight) {
  const Shadow none = render_shadow(options_of(0, 16));
  EXPECT_EQ(test::mean(none.frame.direct), glm::dvec3(0.0));
  EXPECT_EQ(test::mean(none.sun), glm::dvec3(0.0));
}

}  // namespace
}  // namespace eigenlight
