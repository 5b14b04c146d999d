// Direct light of each kind of light against closed forms.
#include <gtest/gtest.h>

#include <array>
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

/// Irradiance / pi at `point` with `normal` from a polygon of unit radiance that lies above the
/// horizon, by Lambert's formula (Arvo 1994): sum of angle(a, b) * dot(unit(cross(a, b)), n) / 2
/// pi.
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

TEST(DirectLight, ConstantSkyGivesDirectLightOnly) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.8f, 0.8f, 0.8f}), 5.0f);
  scene.lights.sky = {1.0f, 2.0f, 3.0f};
  const Extent extent{8, 8};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 4));
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        EXPECT_FLOAT_EQ(at(frame.direct, c, x, y), scene.lights.sky[c]);
        EXPECT_EQ(at(frame.lights[0].radiance, c, x, y), 0.0f);
      }
    }
  }
}

TEST(DirectLight, SunGivesItsIrradianceTimesTheCosineOverPi) {
  for (const float diameter : {0.0f, 0.53f, 20.0f}) {
    Scene scene;
    add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
    scene.lights.suns = {{glm::normalize(glm::vec3(1, 1, 0)), {4.0f, 3.0f, 2.0f}, diameter}};
    const Extent extent{16, 16};
    const Frame frame =
        render_still(scene, test::camera_down(extent), test::render_options(extent, 64));
    EXPECT_NEAR(test::mean(frame.direct).x, 4.0 * std::sqrt(0.5) / kPi, 2e-3) << diameter;
    EXPECT_NEAR(test::mean(frame.direct).z, 2.0 * std::sqrt(0.5) / kPi, 1e-3) << diameter;
  }
}

TEST(DirectLight, SunBelowTheHorizonGivesNoLight) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.suns = {{{0, -1, 0}, {4, 4, 4}, 0.53f}};
  const Extent extent{4, 4};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 4));
  EXPECT_EQ(test::mean(frame.direct), glm::dvec3(0.0));
}

TEST(DirectLight, TwoSunsAddUp) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.suns = {{{0, 1, 0}, {2, 0, 0}, 0.5f},
                       {glm::normalize(glm::vec3(0, 1, 1)), {0, 3, 0}, 0.5f}};
  const Extent extent{16, 16};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 64));
  EXPECT_NEAR(test::mean(frame.direct).x, 2.0 / kPi, 0.01);
  EXPECT_NEAR(test::mean(frame.direct).y, 3.0 * std::sqrt(0.5) / kPi, 0.01);
}

TEST(DirectLight, RectangleMatchesItsFormFactor) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  // It emits downward: cross(half_u, half_v) = -y.
  scene.lights.rects = {{{0.4f, 1.0f, 0.2f}, {0.5f, 0, 0}, {0, 0, 0.3f}, {2.0f, 2.0f, 2.0f}}};
  const Extent extent{3, 3};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 4096));
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

TEST(DirectLight, RectangleShinesFromOneSideOnly) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.rects = {{{0, 1, 0}, {0, 0, 0.3f}, {0.5f, 0, 0}, {2, 2, 2}}};
  const Extent extent{4, 4};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 16));
  EXPECT_EQ(test::mean(frame.direct), glm::dvec3(0.0));
}

// A quad of emissive triangles has the same light as a rectangle light.
TEST(DirectLight, EmissiveTrianglesMatchTheirFormFactor) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  const int lamp = add_material(scene, {0, 0, 0}, {4.0f, 2.0f, 1.0f});
  test::add_quad(scene, lamp,
                 {glm::vec3(-0.1f, 1, -0.1f), glm::vec3(1, 0, 0), glm::vec3(0, 0, 0.6f)});
  scene.lights.emissive_scale = {0.5f, 1.0f, 2.0f};
  const Extent extent{3, 3};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 4096));
  const std::array<glm::dvec3, 4> corners{
      {{-0.1, 1, -0.1}, {0.9, 1, -0.1}, {0.9, 1, 0.5}, {-0.1, 1, 0.5}}};
  const glm::dvec3 p(at(frame.position, 0, 1, 1), 0.0, at(frame.position, 2, 1, 1));
  for (int c = 0; c < 3; ++c) {
    const double expected = 2.0 * polygon_form_factor(p, {0, 1, 0}, corners);
    EXPECT_NEAR(at(frame.direct, c, 1, 1), expected, 0.005 * expected);
  }
}

// The floor straight below a small lamp receives its light along -y.
TEST(DirectLight, TiltScalesEmissionByDirection) {
  const auto direct = [](const glm::vec3& tilt) {
    Scene scene;
    add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
    const int lamp = add_material(scene, {0, 0, 0}, glm::vec3(100.0f));
    test::add_quad(scene, lamp,
                   {glm::vec3(-0.01f, 1, -0.01f), glm::vec3(0.02f, 0, 0), glm::vec3(0, 0, 0.02f)});
    scene.lights.emissive_tilt = tilt;
    const Extent extent{1, 1};
    return test::mean(
               render_still(scene, test::camera_down(extent), test::render_options(extent, 256))
                   .direct)
        .x;
  };
  const double plain = direct({0, 0, 0});
  EXPECT_NEAR(direct({0, -0.5f, 0}) / plain, 1.5, 0.01);
  EXPECT_NEAR(direct({0, 1, 0}) / plain, 0.0, 0.01);
  EXPECT_NEAR(direct({0.7f, 0, 0}) / plain, 1.0, 0.01);
}

// A sphere of radius r straight above at distance d gives L (r / d)^2.
TEST(DirectLight, SphereMatchesItsClosedForm) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.lights.spheres = {{{0, 2, 0}, 0.5f, {3, 3, 3}}};
  const Extent extent{1, 1};
  const Frame frame = render_still(scene, look_at({0, 1, 0}, {0, 0, 0}, {0, 0, 1}, 1.0f, extent),
                                   test::render_options(extent, 4096));
  EXPECT_NEAR(test::mean(frame.direct).x, 3.0 * 0.25 * 0.25, 0.002);
}

TEST(DirectLight, ConstantEnvironmentMatchesASkyOfItsColor) {
  Scene scene;
  add_floor(scene, add_material(scene, {0.5f, 0.5f, 0.5f}), 5.0f);
  scene.environment = Environment{{16, 8}, std::vector<glm::vec3>(128, glm::vec3(0.5f, 1, 2))};
  scene.lights.environment_scale = 2.0f;
  const Extent extent{8, 8};
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 64));
  for (int c = 0; c < 3; ++c) {
    const double expected = 2.0 * scene.environment->radiance[0][c];
    EXPECT_NEAR(test::mean(frame.direct)[c], expected, 0.01 * expected);
  }
}

// One bright texel, which light sampling finds, against quadrature over the bilinear image.
TEST(DirectLight, EnvironmentWithASpotMatchesQuadrature) {
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
  const Frame frame =
      render_still(scene, test::camera_down(extent), test::render_options(extent, 512));
  EXPECT_NEAR(test::mean(frame.direct).x, expected, 0.01 * expected);
}

TEST(DirectLight, LightsOfSeveralKindsAddUp) {
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
    return test::mean(
               render_still(scene, test::camera_down(extent), test::render_options(extent, 256))
                   .direct)
        .x;
  };
  // Light shapes hide the sky behind them, so the sum leaves out the sky.
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

}  // namespace
}  // namespace eigenlight
