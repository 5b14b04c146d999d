// Indirect light, holes and glass against closed forms.
#include "render/paths/path_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using test::add_floor;
using test::add_material;
using test::at;
using test::render_still;

constexpr double kPi = std::numbers::pi;

TEST(PathTracer, FurnaceMatchesTheGeometricSeries) {
  Scene scene;
  const float albedo = 0.6f;
  add_material(scene, glm::vec3(albedo), {1.0f, 2.0f, 0.5f});
  test::add_cube(scene, 0);
  const Extent extent{24, 24};
  RenderOptions o = test::render_options(extent, 32);
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
    RenderOptions o = test::render_options(extent, 64);
    o.bounces = bounces;
    const Frame frame =
        render_still(scene, look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent), o);
    expected += std::pow(0.5, bounces);
    EXPECT_NEAR(test::mean(frame.lights[0].radiance).x, expected, 0.01) << bounces << " bounces";
  }
}

// A black floor below a wide emissive ceiling: the ceiling reflects no light towards the floor.
TEST(PathTracer, EmissionMetByTheFirstBounceCountsAsDirectLight) {
  Scene scene;
  add_floor(scene, add_material(scene, {0, 0, 0}), 100.0f);
  const int lamp = add_material(scene, {0.9f, 0.9f, 0.9f}, glm::vec3(1.0f));
  add_floor(scene, lamp, 100.0f, 1.0f);
  const Extent extent{8, 8};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 256));
  EXPECT_NEAR(test::mean(frame.direct).x, 1.0, 0.01);
  EXPECT_EQ(test::mean(frame.lights[0].radiance).x, 0.0);  // the ceiling only sees the black floor
}

// In a scene of albedo a with lights of radiance L or less, direct light is at most L and indirect
// light at most a / (1 - a) L.
TEST(PathTracer, LightStaysBelowTheFurnaceBound) {
  Scene scene;
  const float albedo = 0.7f;
  const int wall = add_material(scene, glm::vec3(albedo));
  add_floor(scene, wall, 2.0f);
  test::add_quad(scene, wall, {glm::vec3(-2, 0, 1), glm::vec3(4, 0, 0), glm::vec3(0, 2, 0.3f)});
  test::add_quad(scene, wall, {glm::vec3(1, 0, -2), glm::vec3(0, 0, 4), glm::vec3(0.3f, 1, 0)});
  scene.lights.sky = glm::vec3(1.0f);
  scene.lights.rects = {{{0, 1.5f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, glm::vec3(1.0f)}};
  const Extent extent{24, 24};
  RenderOptions o = test::render_options(extent, 256);
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

// The sun stands overhead, above a sheet whose right half is a hole.
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
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 4));
  for (int x = 0; x < 2; ++x) {
    const bool shaded = at(frame.position, 0, x, 0) < 0.0f;
    EXPECT_FLOAT_EQ(at(frame.direct, 0, x, 0), shaded ? 0.0f : 1.0f / static_cast<float>(kPi));
  }
}

TEST(PathTracer, ThinGlassTintsLightButIsInvisible) {
  Scene scene;
  const int floor = add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  const int glass = add_material(scene, {0.5f, 0.25f, 1.0f});
  scene.materials[static_cast<std::size_t>(glass)].thin_glass = true;
  add_floor(scene, glass, 50.0f, 0.2f);  // between camera and floor
  scene.lights.sky = glm::vec3(2.0f);
  const Extent extent{4, 4};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 16));
  EXPECT_EQ(frame.surface.id(1, 1), static_cast<std::uint32_t>(floor) + 1U);
  EXPECT_FLOAT_EQ(at(frame.surface.albedo, 1, 1, 1), 0.5f);
  EXPECT_NEAR(test::mean(frame.direct).x, 1.0, 0.02);
  EXPECT_NEAR(test::mean(frame.direct).y, 0.5, 0.01);
  EXPECT_NEAR(test::mean(frame.direct).z, 2.0, 0.04);
}

TEST(PathTracer, PathsTracedTogetherEqualPathsTracedAlone) {
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

// A wall goes on below a floor. Rays hit the wall where both meet. Rounding can put the hit point
// below the floor, but new rays must start above it.
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
  EXPECT_GT(below, 0);  // some hit points lie below the floor
}

}  // namespace
}  // namespace eigenlight
