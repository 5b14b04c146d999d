// Light against closed forms.
#include "render/paths/path_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using test::add_floor;
using test::add_material;
using test::at;
using test::render_still;

constexpr double kPi = std::numbers::pi;

RenderOptions options(Extent extent, int spp) {
  RenderOptions o;
  o.extent = extent;
  o.spp = o.direct_spp = spp;
  return o;
}

Camera down(Extent extent) { return look_at({0, 0.5f, 0}, {0, 0, 0}, {0, 0, 1}, 40.0f, extent); }

/// Irradiance over pi at `point` with `normal` from a polygon of unit radiance that is wholly above
/// the horizon, by Lambert's formula (Arvo 1994): sum of angle(a, b) * dot(unit(cross(a, b)), n).
double polygon_form_factor(const glm::dvec3& point, const glm::dvec3& normal,
                           const std::array<glm::dvec3, 4>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - point);
    const glm::dvec3 b = glm::normalize(corners[(i + 1) % 4] - point);
    sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(glm::cross(a, b)), normal);
  }
  return std::abs(sum) / (2.0 * kPi);
}

TEST(PathTracer, FurnaceHoldsTheGeometricSeriesAndItsSplit) {
  Scene scene;
  const float albedo = 0.6f;
  add_material(scene, glm::vec3(albedo), {1.0f, 2.0f, 0.5f});
  test::add_cube(scene, 0);
  const Extent extent{24, 24};
  RenderOptions o = options(extent, 32);
  o.bounces = 64;
  const Frame frame =
      render_still(scene, look_at({0.1f, 0, 0}, {1, 0.3f, 0.2f}, {0, 1, 0}, 80.0f, extent), o);
  for (int c = 0; c < 3; ++c) {
    const double e = scene.materials[0].emission[c];
    EXPECT_NEAR(test::mean(frame.emission)[c], e, 1e-6 * e);
    EXPECT_NEAR(test::mean(frame.direct)[c], e, 0.01 * e);
    const double indirect = albedo / (1.0 - albedo) * e;
    EXPECT_NEAR(test::mean(frame.lights[0].radiance)[c], indirect, 0.01 * indirect);
  }
  EXPECT_EQ(frame.non_finite_samples, 0);
}

TEST(PathTracer, EachBounceAddsOneTermOfTheSeries) {
  Scene scene;
  add_material(scene, glm::vec3(0.5f), glm::vec3(1.0f));
  test::add_cube(scene, 0);
  const Extent extent{16, 16};
  double expected = 0.0;
  for (int bounces = 1; bounces <= 3; ++bounces) {
    RenderOptions o = options(extent, 64);
    o.bounces = bounces;
    const Frame frame =
        render_still(scene, look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent), o);
    expected += std::pow(0.5, bounces);
    EXPECT_NEAR(test::mean(frame.lights[0].radiance).x, expected, 0.01) << bounces << " bounces";
  }
}

TEST(PathTracer, ConstantSkyOverAPlaneIsAllDirect) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.8f, 0.8f, 0.8f}), 5.0f);
  scene.lights.sky = {1.0f, 2.0f, 3.0f};
  const Extent extent{8, 8};
  const Frame frame = render_still(scene, down(extent), options(extent, 4));
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        EXPECT_FLOAT_EQ(at(frame.direct, c, x, y), scene.lights.sky[c]);
        EXPECT_EQ(at(frame.lights[0].radiance, c, x, y), 0.0f);
      }
    }
  }
}

TEST(PathTracer, SunGivesItsIrradianceTimesTheCosineOverPi) {
  for (const float diameter : {0.0f, 0.53f, 20.0f}) {
    Scene scene;
    add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
    scene.lights.suns = {{glm::normalize(glm::vec3(1, 1, 0)), {4.0f, 3.0f, 2.0f}, diameter}};
    const Extent extent{16, 16};
    const Frame frame = render_still(scene, down(extent), options(extent, 64));
    EXPECT_NEAR(test::mean(frame.direct).x, 4.0 * std::sqrt(0.5) / kPi, 2e-3) << diameter;
    EXPECT_NEAR(test::mean(frame.direct).z, 2.0 * std::sqrt(0.5) / kPi, 1e-3) << diameter;
  }
}

TEST(PathTracer, SunUnderTheHorizonGivesNothing) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.suns = {{{0, -1, 0}, {4, 4, 4}, 0.53f}};
  const Extent extent{4, 4};
  const Frame frame = render_still(scene, down(extent), options(extent, 4));
  EXPECT_EQ(test::mean(frame.direct), glm::dvec3(0.0));
}

TEST(PathTracer, TwoSunsAddUp) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.suns = {{{0, 1, 0}, {2, 0, 0}, 0.5f},
                       {glm::normalize(glm::vec3(0, 1, 1)), {0, 3, 0}, 0.5f}};
  const Extent extent{16, 16};
  const Frame frame = render_still(scene, down(extent), options(extent, 64));
  EXPECT_NEAR(test::mean(frame.direct).x, 2.0 / kPi, 0.01);
  EXPECT_NEAR(test::mean(frame.direct).y, 3.0 * std::sqrt(0.5) / kPi, 0.01);
}

TEST(PathTracer, RectangleMatchesItsFormFactor) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  // Shines down: cross(half_u, half_v) = -y.
  scene.lights.rects = {{{0.4f, 1.0f, 0.2f}, {0.5f, 0, 0}, {0, 0, 0.3f}, {2.0f, 2.0f, 2.0f}}};
  const Extent extent{3, 3};
  const Frame frame = render_still(scene, down(extent), options(extent, 4096));
  const std::array<glm::dvec3, 4> corners{
      {{-0.1, 1, -0.1}, {0.9, 1, -0.1}, {0.9, 1, 0.5}, {-0.1, 1, 0.5}}};
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      const glm::dvec3 p(at(frame.position, 0, x, y), 0.0, at(frame.position, 2, x, y));
      const double expected = 2.0 * polygon_form_factor(p, {0, 1, 0}, corners);
      EXPECT_NEAR(at(frame.direct, 0, x, y), expected, 0.005 * expected) << x << ", " << y;
    }
  }
}

TEST(PathTracer, RectangleShinesFromOneSideOnly) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.rects = {{{0, 1, 0}, {0, 0, 0.3f}, {0.5f, 0, 0}, {2, 2, 2}}};
  const Extent extent{4, 4};
  const Frame frame = render_still(scene, down(extent), options(extent, 16));
  EXPECT_EQ(test::mean(frame.direct), glm::dvec3(0.0));
}

// A quad of emissive triangles and a rectangle light are the same light.
TEST(PathTracer, EmissiveTrianglesShineAsTheRectangleDoes) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  const int lamp = add_material(scene, {0, 0, 0}, {4.0f, 2.0f, 1.0f});
  test::add_quad(scene, lamp,
                 {glm::vec3(-0.1f, 1, -0.1f), glm::vec3(1, 0, 0), glm::vec3(0, 0, 0.6f)});
  scene.lights.emissive_scale = {0.5f, 1.0f, 2.0f};
  const Extent extent{3, 3};
  const Frame frame = render_still(scene, down(extent), options(extent, 4096));
  const std::array<glm::dvec3, 4> corners{
      {{-0.1, 1, -0.1}, {0.9, 1, -0.1}, {0.9, 1, 0.5}, {-0.1, 1, 0.5}}};
  const glm::dvec3 p(at(frame.position, 0, 1, 1), 0.0, at(frame.position, 2, 1, 1));
  for (int c = 0; c < 3; ++c) {
    const double expected = 2.0 * polygon_form_factor(p, {0, 1, 0}, corners);
    EXPECT_NEAR(at(frame.direct, c, 1, 1), expected, 0.005 * expected);
  }
}

// Straight below a small lamp its light leaves along -y.
TEST(PathTracer, TiltTurnsTheLightOfEmissiveTriangles) {
  const auto direct = [](const glm::vec3& tilt) {
    Scene scene;
    add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
    const int lamp = add_material(scene, {0, 0, 0}, glm::vec3(100.0f));
    test::add_quad(scene, lamp,
                   {glm::vec3(-0.01f, 1, -0.01f), glm::vec3(0.02f, 0, 0), glm::vec3(0, 0, 0.02f)});
    scene.lights.emissive_tilt = tilt;
    const Extent extent{1, 1};
    return test::mean(render_still(scene, down(extent), options(extent, 256)).direct).x;
  };
  const double plain = direct({0, 0, 0});
  EXPECT_NEAR(direct({0, -0.5f, 0}) / plain, 1.5, 0.01);
  EXPECT_NEAR(direct({0, 1, 0}) / plain, 0.0, 0.01);
  EXPECT_NEAR(direct({0.7f, 0, 0}) / plain, 1.0, 0.01);
}

// A sphere of radius r at distance d straight above gives L (r / d)^2.
TEST(PathTracer, SphereGivesItsClosedForm) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.spheres = {{{0, 2, 0}, 0.5f, {3, 3, 3}}};
  const Extent extent{1, 1};
  const Frame frame = render_still(scene, look_at({0, 1, 0}, {0, 0, 0}, {0, 0, 1}, 1.0f, extent),
                                   options(extent, 4096));
  EXPECT_NEAR(test::mean(frame.direct).x, 3.0 * 0.25 * 0.25, 0.002);
}

TEST(PathTracer, EnvironmentOfOneColorIsThatSky) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.environment = Environment{{16, 8}, std::vector<glm::vec3>(128, glm::vec3(0.5f, 1, 2))};
  scene.lights.environment_scale = 2.0f;
  const Extent extent{8, 8};
  const Frame frame = render_still(scene, down(extent), options(extent, 64));
  for (int c = 0; c < 3; ++c) {
    const double expected = 2.0 * scene.environment->radiance[0][c];
    EXPECT_NEAR(test::mean(frame.direct)[c], expected, 0.01 * expected);
  }
}

// One bright texel, found by aiming; the same integral by quadrature over the bilinear image.
TEST(PathTracer, EnvironmentWithASpotMatchesQuadrature) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.environment = Environment{{32, 16}, std::vector<glm::vec3>(512, glm::vec3(0.1f))};
  scene.environment->radiance[4 * 32 + 20] = glm::vec3(200.0f);
  const EnvironmentLight light(scene.environment);
  double expected = 0.0;
  const int steps = 400;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < 4 * steps; ++j) {
      const double theta = 0.5 * kPi * (i + 0.5) / steps, phi = 2.0 * kPi * (j + 0.5) / (4 * steps);
      const glm::vec3 d(std::sin(theta) * std::cos(phi), std::cos(theta),
                        std::sin(theta) * std::sin(phi));
      expected += static_cast<double>(light.radiance(d).x) * std::cos(theta) * std::sin(theta) *
                  (0.5 * kPi / steps) * (2.0 * kPi / (4 * steps)) / kPi;
    }
  }
  const Extent extent{4, 4};
  const Frame frame = render_still(scene, down(extent), options(extent, 512));
  EXPECT_NEAR(test::mean(frame.direct).x, expected, 0.01 * expected);
}

TEST(PathTracer, ManyKindsOfLightAddUpToTheSumOfEachAlone) {
  Scene all;
  add_floor(all, add_material(all, {0.5f, 0.5f, 0.5f}), 5.0f);
  all.lights.sky = glm::vec3(0.1f);
  all.lights.suns = {{{0, 1, 0}, {1, 1, 1}, 0.5f}};
  all.lights.rects = {{{0.8f, 1, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}, {2, 2, 2}}};
  all.lights.spheres = {{{-1.5f, 1, 0}, 0.3f, {5, 5, 5}}};
  const Extent extent{8, 8};
  const auto direct = [&](const Lights& lights) {
    Scene scene = all;
    scene.lights = lights;
    return test::mean(render_still(scene, down(extent), options(extent, 256)).direct).x;
  };
  // Shapes hide the sky behind them, so it is left out of the single ones.
  Lights sun, rect, sphere, lamps = all.lights;
  lamps.sky = glm::vec3(0.0f);
  sun.suns = all.lights.suns;
  rect.rects = all.lights.rects;
  sphere.spheres = all.lights.spheres;
  const double sum = direct(sun) + direct(rect) + direct(sphere);
  EXPECT_NEAR(direct(lamps), sum, 0.01 * sum);
  EXPECT_GT(direct(all.lights), direct(lamps));
  EXPECT_LT(direct(all.lights), direct(lamps) + 0.1);
}

// A floor under a wide lit ceiling: what comes from the ceiling is its reflection of the floor.
TEST(PathTracer, EmissionSeenByTheFirstBounceIsDirectAndCountedOnce) {
  Scene scene;
  add_floor(scene, add_material(scene, {0, 0, 0}), 100.0f);
  const int lamp = add_material(scene, {0.9f, 0.9f, 0.9f}, glm::vec3(1.0f));
  add_floor(scene, lamp, 100.0f, 1.0f);
  const Extent extent{8, 8};
  const Frame frame = render_still(scene, down(extent), options(extent, 256));
  EXPECT_NEAR(test::mean(frame.direct).x, 1.0, 0.01);
  EXPECT_EQ(test::mean(frame.lights[0].radiance).x, 0.0);  // the ceiling sees only black and itself
}

// Any scene of albedo a under lights of radiance at most L: direct <= L, indirect <= a / (1 - a) L.
TEST(PathTracer, LightNeverExceedsTheBoundOfTheFurnace) {
  Scene scene;
  const float albedo = 0.7f;
  const int wall = add_material(scene, glm::vec3(albedo));
  add_floor(scene, wall, 2.0f);
  test::add_quad(scene, wall, {glm::vec3(-2, 0, 1), glm::vec3(4, 0, 0), glm::vec3(0, 2, 0.3f)});
  test::add_quad(scene, wall, {glm::vec3(1, 0, -2), glm::vec3(0, 0, 4), glm::vec3(0.3f, 1, 0)});
  scene.lights.sky = glm::vec3(1.0f);
  scene.lights.rects = {{{0, 1.5f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, glm::vec3(1.0f)}};
  const Extent extent{24, 24};
  RenderOptions o = options(extent, 256);
  o.bounces = 32;
  const Frame frame =
      render_still(scene, look_at({0, 1, -2}, {0, 0.5f, 1}, {0, 1, 0}, 60, extent), o);
  double brightest = 0.0;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      EXPECT_LE(at(frame.direct, 0, x, y), 1.05f);
      EXPECT_LE(at(frame.lights[0].radiance, 0, x, y), 1.05f * albedo / (1.0f - albedo));
      brightest = std::max(brightest, static_cast<double>(at(frame.lights[0].radiance, 0, x, y)));
    }
  }
  EXPECT_GT(brightest, 0.1);
}

// A sun overhead through a sheet whose right half is a hole.
TEST(PathTracer, HolesLetLightThrough) {
  Scene scene;
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  const int leaf = add_material(scene, glm::vec3(0.0f));
  scene.textures.push_back({"half", {8, 8}, std::vector<std::uint8_t>(256, 255)});
  for (std::size_t i = 0; i < 64; ++i) {
    if (i % 8 >= 4) scene.textures[0].rgba[4 * i + 3] = 0;
  }
  scene.materials[static_cast<std::size_t>(leaf)].texture = 0;
  scene.materials[static_cast<std::size_t>(leaf)].alpha_cutoff = 0.5f;
  test::add_quad(scene, leaf, {glm::vec3(-2, 1, -2), glm::vec3(4, 0, 0), glm::vec3(0, 0, 4)});
  scene.lights.suns = {{{0, 1, 0}, glm::vec3(1.0f), 0.0f}};
  const Extent extent{2, 1};
  const Frame frame = render_still(scene, down(extent), options(extent, 4));
  for (int x = 0; x < 2; ++x) {
    const bool shaded = at(frame.position, 0, x, 0) < 0.0f;
    EXPECT_FLOAT_EQ(at(frame.direct, 0, x, 0), shaded ? 0.0f : 1.0f / static_cast<float>(kPi));
  }
}

TEST(PathTracer, ThinGlassTintsLightAndIsNotSeen) {
  Scene scene;
  const int floor = add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  const int glass = add_material(scene, {0.5f, 0.25f, 1.0f});
  scene.materials[static_cast<std::size_t>(glass)].thin_glass = true;
  add_floor(scene, glass, 50.0f, 0.2f);  // between camera and floor
  scene.lights.sky = glm::vec3(2.0f);
  const Extent extent{4, 4};
  const Frame frame = render_still(scene, down(extent), options(extent, 16));
  EXPECT_EQ(frame.surface.id(1, 1), static_cast<std::uint32_t>(floor) + 1U);
  EXPECT_FLOAT_EQ(at(frame.surface.albedo, 1, 1, 1), 0.5f);
  EXPECT_NEAR(test::mean(frame.direct).x, 1.0, 0.02);
  EXPECT_NEAR(test::mean(frame.direct).y, 0.5, 0.01);
  EXPECT_NEAR(test::mean(frame.direct).z, 2.0, 0.04);
}

TEST(PathTracer, PathsSideBySideAreThoseOfEachAlone) {
  Scene scene;
  add_material(scene, {0.7f, 0.5f, 0.3f}, {0.2f, 0.1f, 0.0f});
  add_material(scene, {0.9f, 0.9f, 0.9f});
  test::add_cube(scene, 0);
  add_floor(scene, 1, 0.3f);
  scene.lights.rects = {{{0, 0.9f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}, {3, 2, 1}}};
  const EmbreeScene geometry(scene);
  const SurfaceTable surfaces(scene, geometry);
  LightSet lights(scene, geometry);
  lights.update(scene.lights);
  const PathTracer tracer({geometry, surfaces, lights}, 5);
  const SurfacePoint point{
      {0.1f, -0.9f, 0}, {0, 1, 0}, {0, 1, 0}, glm::vec3(0.5f), {0.1f, -0.89999f, 0}};
  std::vector<PathTracer::Path> paths;
  for (std::uint32_t i = 0; i < 3 * PathTracer::kSideBySide + 5; ++i) {
    paths.emplace_back(point, Sampler(7, i));
  }
  std::int64_t rays = 0, rays_alone = 0;
  tracer.indirect(paths, rays);
  bool any = false;
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    const glm::vec3 alone = tracer.indirect(point, Sampler(7, i), rays_alone);
    EXPECT_EQ(paths[i].light, alone) << "path " << i;
    any = any || alone.x > 0.0f;
  }
  EXPECT_TRUE(any);
  EXPECT_EQ(rays, rays_alone);
}

// A wall that goes on below a floor: what is seen where they meet is above the floor, though the
// point may be rounded to below it, and so is light that reaches it.
TEST(PathTracer, NoRayStartsInsideTheNextWall) {
  Scene scene;
  add_material(scene, glm::vec3(0.5f));
  add_floor(scene, 0, 3.0f, 0.3f);
  test::add_quad(scene, 0, {glm::vec3(-3, -1, 0.7f), glm::vec3(6, 0, 0), glm::vec3(0, 4.1f, 0)});
  const EmbreeScene geometry(scene);
  const SurfaceTable surfaces(scene, geometry);
  int below = 0;
  for (int i = 0; i < 4000; ++i) {
    Sampler draw(1, static_cast<std::uint32_t>(i));
    const glm::vec2 from = draw.next_2d(), slope = draw.next_2d();
    const glm::vec3 eye(4.0f * from.x - 2.0f, 0.4f + 2.0f * from.y, -2.0f * slope.x);
    const glm::vec3 seam(4.0f * slope.y - 2.0f, 0.3f, 0.7f);
    const Ray ray{eye, glm::normalize(seam - eye)};
    const auto hit = geometry.intersect(ray);
    ASSERT_TRUE(hit);
    const SurfacePoint guide = surfaces.guide_point(ray, *hit, 0.001f);
    const SurfacePoint bounce = surfaces.bounce_point(ray, *hit).point;
    below += guide.position.y < 0.3f ? 1 : 0;
    for (const SurfacePoint& point : {guide, bounce}) {
      EXPECT_FALSE(geometry.occluded({point.origin, {0, 1, 0}})) << "ray " << i;
      EXPECT_FALSE(geometry.occluded({point.origin, {0, 0, -1}})) << "ray " << i;
    }
  }
  EXPECT_GT(below, 0);  // or this tests nothing
}

}  // namespace
}  // namespace eigenlight
