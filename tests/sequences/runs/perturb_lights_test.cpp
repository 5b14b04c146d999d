#include "sequences/runs/perturb_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "render/builtin/builtin_scenes.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(LightPerturbation, SunSweepsBothWaysAndPulses) {
  Scene scene;
  scene.lights.suns.push_back({normalize(glm::vec3(1, 1, 1)), {10, 9, 8}});
  scene.lights.sky = {1, 1, 1};
  const LightPerturbation lights(scene);
  const glm::vec3 rest = scene.lights.suns[0].to_light;
  float lowest = 90.0f, highest = 0.0f, dimmest = kInfinity, brightest = 0.0f;
  for (int frame = 0; frame < kLightPeriod; ++frame) {
    const SunLight sun = lights.at(frame).suns.at(0);
    EXPECT_NEAR(length(sun.to_light), 1.0f, 1e-5f);
    EXPECT_NEAR(sun.to_light.x, sun.to_light.z, 1e-5f);  // the azimuth stays
    lowest = std::min(lowest, glm::degrees(std::asin(sun.to_light.y)));
    highest = std::max(highest, glm::degrees(std::asin(sun.to_light.y)));
    dimmest = std::min(dimmest, sun.irradiance.x);
    brightest = std::max(brightest, sun.irradiance.x);
    EXPECT_EQ(lights.at(frame).sky, scene.lights.sky);
    EXPECT_EQ(lights.at(frame - 5 * kLightPeriod).suns[0].to_light, sun.to_light);
  }
  // The largest of sin(2 pi f / 18) over whole frames is sin(80 degrees).
  const float height = glm::degrees(std::asin(rest.y)), sweep = 20.0f * 0.9848f;
  EXPECT_NEAR(lowest, height - sweep, 0.05f);
  EXPECT_NEAR(highest, height + sweep, 0.05f);
  EXPECT_NEAR(dimmest, 4.0f, 1e-4f);
  EXPECT_NEAR(brightest, 16.0f, 1e-4f);
}

TEST(LightPerturbation, LowSunsStayAboveTheHorizon) {
  for (const glm::vec3& to_light : {glm::vec3(1, 0.05f, 0), glm::vec3(0.3f, 0.4f, -0.8f),
                                    glm::vec3(0, 1, 0), glm::vec3(0, 1, 0.1f)}) {
    Scene scene;
    scene.lights.suns.push_back({normalize(to_light), {1, 1, 1}});
    const LightPerturbation lights(scene);
    for (int frame = 0; frame < kLightPeriod; ++frame) {
      EXPECT_GT(lights.at(frame).suns[0].to_light.y, std::sin(glm::radians(4.9f)));
    }
  }
}

/// Degrees between the normals of a rect at rest and at its farthest.
float farthest_tilt(const LightPerturbation& lights, const AreaRect& rest, std::size_t index) {
  float farthest = 0.0f;
  for (int frame = 0; frame < kLightPeriod; ++frame) {
    const AreaRect rect = lights.at(frame).rects.at(index);
    const float cosine =
        dot(normalize(cross(rect.half_u, rect.half_v)), normalize(cross(rest.half_u, rest.half_v)));
    farthest = std::max(farthest, glm::degrees(std::acos(std::min(1.0f, cosine))));
  }
  return farthest;
}

TEST(LightPerturbation, OnlyTheStrongestRectTilts) {
  Scene scene;
  scene.lights.rects.push_back({{0, 3, 0}, {0, 0, 1}, {1, 0, 0}, glm::vec3(5)});
  scene.lights.rects.push_back({{5, 3, 0}, {0, 0, 1}, {1, 0, 0}, glm::vec3(6)});
  const LightPerturbation lights(scene);
  EXPECT_NEAR(farthest_tilt(lights, scene.lights.rects[1], 1), 19.7f, 0.1f);
  EXPECT_LT(farthest_tilt(lights, scene.lights.rects[0], 0), 0.1f);
  EXPECT_NEAR(lights.at(0).rects[1].radiance.x, 6.0f * 1.6f, 1e-4f);
  EXPECT_EQ(lights.at(0).rects[0].radiance, glm::vec3(5));
}

TEST(LightPerturbation, SphereSwingsByAboutItsRadius) {
  Scene scene;
  scene.lights.spheres.push_back({{1, 2, 3}, 0.5f, glm::vec3(9)});
  const LightPerturbation lights(scene);
  float farthest = 0.0f;
  for (int frame = 0; frame < kLightPeriod; ++frame) {
    farthest = std::max(farthest, distance(lights.at(frame).spheres[0].center, {1, 2, 3}));
  }
  // The chord of 19.7 degrees on a pendulum of three radii.
  EXPECT_NEAR(farthest, 2.0f * 1.5f * std::sin(glm::radians(19.7f / 2.0f)), 1e-3f);
}

TEST(LightPerturbation, EmissiveTrianglesSwingTheirLobe) {
  Scene scene;
  scene.materials.emplace_back().emission = glm::vec3(4);
  scene.meshes.push_back({"lamp", {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {}, {}, {{0, 1, 2}}, 0});
  scene.instances.push_back({0, glm::mat4(1.0f)});
  const LightPerturbation lights(scene);
  float farthest = 0.0f;
  for (int frame = 0; frame < kLightPeriod; ++frame) {
    const glm::vec3 tilt = lights.at(frame).emissive_tilt;
    EXPECT_LE(length(tilt), 1.0f);
    farthest = std::max(farthest, glm::degrees(std::acos(-tilt.y / length(tilt))));
  }
  EXPECT_NEAR(farthest, 19.7f, 0.1f);
  EXPECT_NEAR(lights.at(9).emissive_scale.x, 0.4f, 1e-5f);
}

/// What the main light of a scene is multiplied by at a frame, as the darkest and the brightest
/// color say.
glm::vec2 factor(const Lights& now, const Lights& rest) {
  glm::vec2 range(kInfinity, 0.0f);
  const auto compare = [&](const glm::vec3& a, const glm::vec3& b) {
    for (int c = 0; c < 3; ++c) {
      if (b[c] > 0.0f) range = {std::min(range.x, a[c] / b[c]), std::max(range.y, a[c] / b[c])};
    }
  };
  compare(now.sky, rest.sky);
  compare(now.emissive_scale, rest.emissive_scale);
  for (std::size_t i = 0; i < rest.suns.size(); ++i) {
    compare(now.suns[i].irradiance, rest.suns[i].irradiance);
    EXPECT_EQ(now.suns[i].to_light, rest.suns[i].to_light);
  }
  for (std::size_t i = 0; i < rest.rects.size(); ++i) {
    compare(now.rects[i].radiance, rest.rects[i].radiance);
    EXPECT_EQ(now.rects[i].half_v, rest.rects[i].half_v);
  }
  for (std::size_t i = 0; i < rest.spheres.size(); ++i) {
    compare(now.spheres[i].radiance, rest.spheres[i].radiance);
    EXPECT_EQ(now.spheres[i].center, rest.spheres[i].center);
  }
  return range;
}

class StepInLight : public testing::TestWithParam<BuiltinScene> {};

TEST_P(StepInLight, BrightensTheMainLightFromTheStepOn) {
  const Scene scene = GetParam().make();
  const LightStep step(scene, 24);
  for (const int frame : {-5, 0, 23}) {
    EXPECT_EQ(factor(step.at(frame), scene.lights), glm::vec2(1.0f)) << frame;
  }
  for (const int frame : {24, 25, 100000}) {
    EXPECT_NEAR(factor(step.at(frame), scene.lights).y, kLightStep, 1e-5f) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(All, StepInLight, testing::ValuesIn(builtin_scenes()),
                         [](const auto& built) { return std::string(built.param.name); });

TEST(LightStep, OtherLightsDoNotStep) {
  Scene scene;
  scene.lights.rects.push_back({{0, 3, 0}, {0, 0, 1}, {1, 0, 0}, glm::vec3(5)});
  scene.lights.spheres.push_back({{5, 3, 0}, 4.0f, glm::vec3(6)});
  scene.lights.sky = {1, 2, 3};
  const LightStep step(scene, 1);
  EXPECT_EQ(step.at(1).spheres[0].radiance, glm::vec3(6.0f * kLightStep));
  EXPECT_EQ(step.at(1).rects[0].radiance, glm::vec3(5));
  EXPECT_EQ(step.at(1).sky, scene.lights.sky);
}

TEST(LightStep, SkyAndEnvironmentStepTogether) {
  Scene scene;
  scene.lights.sky = {1, 2, 3};
  const LightStep step(scene, 7);
  EXPECT_EQ(step.at(7).sky, kLightStep * scene.lights.sky);
  EXPECT_EQ(step.at(7).environment_scale, kLightStep);
  EXPECT_EQ(step.at(6).environment_scale, 1.0f);
}

TEST(LightPerturbation, SkyPulsesWithoutMoving) {
  Scene scene;
  scene.lights.sky = {1, 2, 3};
  const LightPerturbation lights(scene);
  EXPECT_NEAR(lights.at(0).sky.y, 3.2f, 1e-5f);
  EXPECT_NEAR(lights.at(9).environment_scale, 0.4f, 1e-5f);
}

}  // namespace
}  // namespace eigenlight
