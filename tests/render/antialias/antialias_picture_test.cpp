// Antialiased pictures of scenes whose light is known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/tiles.h"
#include "render/antialias/picture.h"
#include "tests/support/extents.h"
#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr AntialiasOptions kLookup{AntialiasMode::kLookup, 1};
constexpr AntialiasOptions kSraa{AntialiasMode::kSraa, 1};
constexpr AntialiasOptions kFour{AntialiasMode::kSupersample, 4};
constexpr AntialiasOptions kAll[] = {kLookup, kSraa, kFour};

RenderOptions options_of(Extent extent) {
  RenderOptions o;
  o.extent = extent;
  o.spp = 2;
  o.direct_spp = 4;
  return o;
}

struct Picture {
  Frame frame;
  Planes<3> color;
  PictureStats stats;
};

struct View {
  Camera camera;
  RenderOptions options;
};

Picture picture_of(const Scene& scene, const View& view, const AntialiasOptions& aa) {
  const test::FunctionAnimation animation = test::still(scene, view.camera);
  LiveSource source(scene, animation, view.options, {0});
  Picture picture;
  if (!source.next(picture.frame)) throw std::logic_error("no frame");
  picture.stats =
      source.picture(aa, picture.frame, picture.frame.lights[0].radiance, picture.color);
  return picture;
}

View ahead(Extent extent, const glm::vec3& eye = glm::vec3(0.0f)) {
  return {look_at(eye, eye + glm::vec3(0, 0, 1), {0, 1, 0}, 60.0f, extent), options_of(extent)};
}

/// A wall at z = 4 on one side of a slanted line, in front of a sky of radiance 2. It has albedo
/// 1/2 and sees only the sky, so its outgoing radiance is 1.
Scene slanted_wall() {
  Scene scene;
  test::add_quad(scene, test::add_material(scene, glm::vec3(0.5f)),
                 {glm::vec3(-3.9f, -40, 4), glm::vec3(40, 0, 0), glm::vec3(8, 80, 0)});
  scene.lights.sky = glm::vec3(2.0f);
  return scene;
}

// Pixels that one surface covers entirely keep their color.
TEST(Picture, FlatRegionsDoNotChange) {
  const View view = ahead({24, 16});
  const Scene scene = slanted_wall();
  for (const AntialiasOptions& aa : kAll) {
    const Picture picture = picture_of(scene, view, aa);
    int wall = 0, sky = 0;
    for (int y = 1; y < 15; ++y) {
      for (int x = 1; x < 23; ++x) {
        bool flat = true;
        for (int i = 0; i < 9; ++i) {
          flat &= picture.frame.surface.id(x + i % 3 - 1, y + i / 3 - 1) ==
                  picture.frame.surface.id(x, y);
        }
        if (!flat) continue;
        const bool is_sky = picture.frame.surface.id(x, y) == 0;
        ++(is_sky ? sky : wall);
        EXPECT_NEAR(picture.color[1](x, y), is_sky ? 2.0f : 1.0f, 1e-5f) << x << ' ' << y;
      }
    }
    EXPECT_GT(wall, 50);
    EXPECT_GT(sky, 50);
  }
}

// The radiance of a pixel on the edge is the mean of wall and sky, weighted by coverage. Five rays
// estimate coverage much better than one.
TEST(Picture, EdgesAgainstTheSkyShowCoverage) {
  View view = ahead({48, 32});
  view.options.spp = view.options.direct_spp = 1;  // the sky has no noise
  const Scene scene = slanted_wall();
  AntialiasOptions fine = kFour;
  fine.samples = 256;
  const Picture truth = picture_of(scene, view, fine);
  const auto error = [&](const Planes<3>& color) {
    double sum = 0.0;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 48; ++x) {
        sum += std::pow(static_cast<double>(color[0](x, y) - truth.color[0](x, y)), 2.0);
      }
    }
    return sum;
  };
  Planes<3> hard = make_planes<3>({48, 32});
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x) hard[0](x, y) = truth.frame.surface.id(x, y) == 0 ? 2.0f : 1.0f;
  }
  const double before = error(hard);
  EXPECT_GT(before, 1.0);
  AntialiasOptions sixteen = kFour;
  sixteen.samples = 16;
  for (const AntialiasOptions& aa : {kLookup, kSraa, sixteen}) {
    // With five rays the coverage errs by up to 1/10 of a pixel, with one by 1/2: 1/25 in squares.
    // A jittered 4 x 4 grid errs in the 4 cells along the edge: 1/32.
    EXPECT_LT(error(picture_of(scene, view, aa).color), 0.06 * before) << format_antialias(aa);
  }
}

/// Bars of a fifth of a pixel in front of a black sky, lit by a lamp behind the camera.
Scene thin_bars(const View& view) {
  Scene scene;
  const int material = test::add_material(scene, glm::vec3(0.8f));
  const float pixel = 4.0f / view.camera.focal;
  for (int i = -8; i < 8; ++i) {
    const float x = pixel * (1.37f * static_cast<float>(i) + 0.3f);
    test::add_quad(scene, material,
                   {glm::vec3(x, -9, 4), glm::vec3(0.2f * pixel, 0, 0), glm::vec3(0, 18, 0)});
  }
  scene.lights.spheres = {{{0, 0, -6}, 1.0f, glm::vec3(40.0f)}};
  return scene;
}

// No guide ray meets some of the bars. They must still be visible with the right brightness.
TEST(Picture, FeaturesThinnerThanAPixelAreVisible) {
  const View view = ahead({30, 20});
  const Scene scene = thin_bars(view);
  AntialiasOptions fine = kFour;
  fine.samples = 64;
  const double truth = test::mean(picture_of(scene, view, fine).color).x;
  for (const AntialiasOptions& aa : {kLookup, kSraa}) {
    const Picture picture = picture_of(scene, view, aa);
    EXPECT_GT(picture.stats.unmatched, 50) << format_antialias(aa);
    EXPECT_EQ(picture.stats.non_finite, 0);
    EXPECT_NEAR(test::mean(picture.color).x, truth, 0.2 * truth) << format_antialias(aa);
    for (int y = 0; y < 20; ++y) {
      int lit = 0;
      for (int x = 0; x < 30; ++x) lit += picture.color[0](x, y) > 0.0f;
      EXPECT_GE(lit, 12) << format_antialias(aa);
    }
  }
}

/// A floor and a block of another color under a sun, a lamp and a sky, with every kind of edge.
Scene still_life() {
  Scene scene;
  const int grey = test::add_material(scene, glm::vec3(0.6f));
  const int red = test::add_material(scene, {0.7f, 0.2f, 0.1f});
  test::add_floor(scene, grey, 6.0f, -1.0f);
  test::add_quad(scene, red,
                 {glm::vec3(-1, -1, 3), glm::vec3(1.7f, 0, 0.4f), glm::vec3(0, 1.3f, 0)});
  test::add_quad(scene, red,
                 {glm::vec3(0.7f, -1, 3.4f), glm::vec3(0.3f, 0, 2), glm::vec3(0, 1.3f, 0)});
  scene.lights.suns = {{glm::normalize(glm::vec3(1, 2, -0.6f)), glm::vec3(3.0f), 0.5f}};
  scene.lights.rects = {{{-1.2f, 1.2f, 4}, {0.4f, 0, 0}, {0, 0.2f, 0.2f}, glm::vec3(5.0f)}};
  scene.lights.sky = glm::vec3(0.2f, 0.3f, 0.5f);
  return scene;
}

TEST(Picture, ThreadCountDoesNotChangeTheBits) {
  const Scene scene = still_life();
  const View view = ahead({40, 24});
  for (const AntialiasOptions& aa : kAll) {
    set_thread_count(1);
    const Picture one = picture_of(scene, view, aa);
    set_thread_count(2);
    const Picture two = picture_of(scene, view, aa);
    set_thread_count(0);
    EXPECT_TRUE(test::same_bits(one.color, two.color)) << format_antialias(aa);
    EXPECT_EQ(one.stats.rays, two.stats.rays);
    EXPECT_EQ(one.stats.unmatched, two.stats.unmatched);
  }
}

// Denoisers read the frame, so a picture must change neither the frame nor the samples of
// resample().
TEST(Picture, PictureDoesNotChangeTheFrame) {
  const Scene scene = still_life();
  const View view = ahead({20, 12});
  const test::FunctionAnimation animation = test::still(scene, view.camera);
  Plane<std::uint8_t> extra(view.options.extent);
  extra.fill(2);
  LiveSource plain(scene, animation, view.options, {0});
  Frame untouched;
  Planes<3> wanted;
  ASSERT_TRUE(plain.next(untouched) && resample(plain, extra, untouched, wanted));
  for (const AntialiasOptions& aa : kAll) {
    LiveSource source(scene, animation, view.options, {0});
    Frame frame;
    Planes<3> color, more;
    ASSERT_TRUE(source.next(frame));
    (void)source.picture(aa, frame, frame.lights[0].radiance, color);
    ASSERT_TRUE(resample(source, extra, frame, more));
    EXPECT_TRUE(test::same_bits(more, wanted));
    EXPECT_TRUE(test::same_bits(frame.lights[0].radiance, untouched.lights[0].radiance));
    EXPECT_TRUE(test::same_bits(frame.direct, untouched.direct));
    EXPECT_TRUE(test::same_bits(frame.surface.normal, untouched.surface.normal));
    EXPECT_TRUE(test::same_bits(frame.surface.albedo, untouched.surface.albedo));
  }
}

TEST(Picture, PictureOfAnyExtentIsFinite) {
  const Scene scene = still_life();
  for (const Extent extent : {kSweepExtents[0], kSweepExtents[1], kSweepExtents[3]}) {
    const View view = ahead(extent);
    for (const AntialiasOptions& aa : kAll) {
      const Picture picture = picture_of(scene, view, aa);
      EXPECT_EQ(picture.color[0].extent(), extent);
      EXPECT_EQ(picture.stats.non_finite, 0);
      EXPECT_TRUE(std::isfinite(test::mean(picture.color).x));
    }
  }
}

// The picture shows the given indirect light, and a NaN pixel does not spread.
TEST(Picture, PictureUsesDenoisedLightAndNanDoesNotSpread) {
  const View view = ahead({16, 12});
  Scene scene;
  test::add_quad(scene, test::add_material(scene, glm::vec3(0.5f)),
                 {glm::vec3(-40, -40, 4), glm::vec3(80, 0, 0), glm::vec3(0, 80, 0)});
  const test::FunctionAnimation animation = test::still(scene, view.camera);
  for (const AntialiasOptions& aa : {kLookup, kSraa}) {
    LiveSource source(scene, animation, view.options, {0});
    Frame frame;
    ASSERT_TRUE(source.next(frame));
    Planes<3> indirect = make_planes<3>(view.options.extent), color;
    for (auto& plane : indirect) plane.fill(3.0f);
    indirect[2](7, 5) = std::numeric_limits<float>::quiet_NaN();
    const PictureStats stats = source.picture(aa, frame, indirect, color);
    EXPECT_EQ(stats.non_finite, 1);  // the guide ray of that pixel
    EXPECT_EQ(stats.unmatched, 0);
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 16; ++x) ASSERT_FLOAT_EQ(color[2](x, y), 1.5f) << x << ' ' << y;
    }
  }
}

TEST(Picture, ErrorNamesTheBadInput) {
  const Scene scene = still_life();
  const View view = ahead({8, 6});
  const test::FunctionAnimation animation = test::still(scene, view.camera);
  LiveSource source(scene, animation, view.options, {0, 1});
  Frame frame;
  Planes<3> color;
  ASSERT_TRUE(source.next(frame));
  const auto render = [&](AntialiasOptions aa, const Planes<3>& indirect) {
    return [&source, &frame, &color, &indirect, aa] {
      (void)source.picture(aa, frame, indirect, color);
    };
  };
  const Planes<3> small = make_planes<3>({4, 4});
  EXPECT_THAT(render({}, frame.lights[0].radiance),
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected a mode that renders")));
  EXPECT_THAT(render({AntialiasMode::kSupersample, 1}, frame.lights[0].radiance),
              ThrowsMessage<std::invalid_argument>(HasSubstr("1 samples, expected 2 to 1024")));
  EXPECT_THAT(render(kSraa, small),
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected one size")));
  frame.index = 1;
  EXPECT_THAT(render(kLookup, frame.lights[0].radiance),
              ThrowsMessage<std::invalid_argument>(HasSubstr("frame 1 is not the last frame")));
}

}  // namespace
}  // namespace eigenlight
