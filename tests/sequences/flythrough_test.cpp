#include "sequences/flythrough.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>

#include "render/builtin_scenes.h"
#include "render/clearance.h"
#include "render/embree_scene.h"
#include "sequences/camera_path.h"
#include "sequences/perturb_lights.h"
#include "sequences/perturb_objects.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Extent kExtent{160, 90};

const std::vector<CameraKey> kKeys{{1.0f, {0, 0, 0}, {0, 0, 1}},
                                   {2.0f, {1, 2, 0}, {1, 2, 5}},
                                   {2.5f, {4, 1, 1}, {5, 1, 9}},
                                   {5.0f, {7, 0, 3}, {0, 0, 0}}};

TEST(CameraPath, PassesThroughItsKeys) {
  const CameraPath path(kKeys, 24.0f);
  EXPECT_EQ(path.length(), 96);
  for (const CameraKey& key : kKeys) {
    const CameraPath::View view = path.at(static_cast<int>((key.seconds - 1.0f) * 24.0f));
    EXPECT_LT(distance(view.eye, key.eye), 1e-4f);
    EXPECT_LT(distance(view.look_at, key.look_at), 1e-4f);
  }
}

TEST(CameraPath, TurnsBackAtItsEndsForEver) {
  const CameraPath path(kKeys, 24.0f);
  for (int frame = 0; frame <= path.length(); ++frame) {
    for (const int same : {-frame, frame + path.period(), frame - 3 * path.period()}) {
      EXPECT_EQ(path.at(frame).eye, path.at(same).eye) << frame;
      EXPECT_EQ(path.at(frame).look_at, path.at(same).look_at) << frame;
    }
  }
}

// A straight line at constant speed is reproduced between its inner keys.
TEST(CameraPath, KeepsConstantSpeedOnALine) {
  std::vector<CameraKey> keys;
  for (const float t : {0.0f, 1.0f, 1.5f, 3.0f, 4.0f}) {
    keys.push_back({t, {2.0f * t, 0, 0}, {2.0f * t, 0, 1}});
  }
  const CameraPath path(keys, 24.0f);
  for (int frame = 24; frame <= 72; ++frame) {
    EXPECT_NEAR(path.at(frame).eye.x, 2.0f * static_cast<float>(frame) / 24.0f, 1e-4f);
  }
}

TEST(CameraPath, OneKeyStandsStill) {
  const CameraPath path({{3.0f, {1, 2, 3}, {4, 5, 6}}}, 24.0f);
  for (const int frame : {-7, 0, 100}) EXPECT_EQ(path.at(frame).eye, glm::vec3(1, 2, 3));
}

TEST(CameraPath, RefusesBadKeys) {
  EXPECT_THROW(CameraPath({}, 24.0f), std::invalid_argument);
  EXPECT_THROW(CameraPath({kKeys[1], kKeys[0]}, 24.0f), std::invalid_argument);
  std::vector<CameraKey> broken = kKeys;
  broken[2].eye.y = std::nanf("");
  EXPECT_THROW(CameraPath(broken, 24.0f), std::invalid_argument);
}

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

TEST(LightPerturbation, SkyAlonePulses) {
  Scene scene;
  scene.lights.sky = {1, 2, 3};
  const LightPerturbation lights(scene);
  EXPECT_NEAR(lights.at(0).sky.y, 3.2f, 1e-5f);
  EXPECT_NEAR(lights.at(9).environment_scale, 0.4f, 1e-5f);
}

class CrossingObjects : public testing::TestWithParam<BuiltinScene> {};

TEST_P(CrossingObjects, NeverTouchASurface) {
  Scene scene = GetParam().make();
  const Clearance clearance(scene);
  const CameraPath path(scene.camera_path, kFramesPerSecond);
  const ObjectPerturbation objects(scene, path, kExtent);
  for (int frame = 0; frame < path.period(); ++frame) {
    for (std::size_t i = 0; i < ObjectPerturbation::kCount; ++i) {
      const auto ball = objects.ball(i, frame);
      ASSERT_GT(ball.radius, 0.0f);
      ASSERT_GT(clearance.distance(ball.center, kInfinity), ball.radius) << i << " at " << frame;
    }
    const auto a = objects.ball(0, frame), b = objects.ball(1, frame);
    ASSERT_GT(distance(a.center, b.center), a.radius + b.radius) << frame;
  }
}

TEST_P(CrossingObjects, AreInFullViewAndLargeEnough) {
  Scene scene = GetParam().make();
  const auto animation = make_flythrough(scene, Perturbation::kObjects, kExtent);
  const CameraPath path(scene.camera_path, kFramesPerSecond);
  EmbreeScene geometry(scene, ObjectPerturbation::kCount);
  for (int frame = 0; frame < path.period(); frame += 3) {
    const SceneState state = animation->state(frame);
    geometry.set_poses(state.poses);
    for (std::size_t i = 0; i < ObjectPerturbation::kCount; ++i) {
      const glm::vec3 center(state.poses[i][3]);
      const glm::vec2 pixel = state.camera.view_to_pixel(state.camera.to_view(center));
      ASSERT_TRUE(kExtent.contains(static_cast<int>(pixel.x), static_cast<int>(pixel.y)));
      const auto hit = geometry.intersect({state.camera.eye, normalize(center - state.camera.eye)});
      ASSERT_TRUE(hit.has_value());
      ASSERT_EQ(hit->instance, scene.instances.size() - ObjectPerturbation::kCount + i) << frame;
      const float radius = length(glm::vec3(state.poses[i][0]));
      // A tenth of the view's height across, at least.
      ASSERT_GT(2.0f * radius / distance(center, state.camera.eye) * state.camera.focal, 9.0f);
    }
  }
}

TEST_P(CrossingObjects, CrossTheViewSmoothly) {
  Scene scene = GetParam().make();
  const CameraPath path(scene.camera_path, kFramesPerSecond);
  const ObjectPerturbation objects(scene, path, kExtent);
  for (std::size_t i = 0; i < ObjectPerturbation::kCount; ++i) {
    float left = kInfinity, right = -kInfinity;
    for (int frame = 0; frame < path.period(); ++frame) {
      const auto view = path.at(frame);
      const Camera camera = look_at(view.eye, view.look_at, scene.up, scene.fov_y, kExtent);
      const glm::vec3 here = camera.to_view(objects.ball(i, frame).center);
      left = std::min(left, camera.view_to_pixel(here).x);
      right = std::max(right, camera.view_to_pixel(here).x);
      const auto next_view = path.at(frame + 1);
      const Camera next = look_at(next_view.eye, next_view.look_at, scene.up, scene.fov_y, kExtent);
      const glm::vec3 there = next.to_view(objects.ball(i, frame + 1).center);
      // Seen from the camera: under a quarter of its distance a frame.
      ASSERT_LT(distance(here, there), 0.25f * length(here)) << frame;
    }
    EXPECT_LT(left, 0.2f * static_cast<float>(kExtent.width));
    EXPECT_GT(right, 0.8f * static_cast<float>(kExtent.width));
  }
}

INSTANTIATE_TEST_SUITE_P(All, CrossingObjects, testing::ValuesIn(builtin_scenes()),
                         [](const auto& built) { return std::string(built.param.name); });

TEST(Flythrough, PerturbsWhatItIsToldTo) {
  const Scene plain = make_builtin_scene("cornell");
  for (const auto& [name, lights, objects] : {std::tuple{"none", false, 0U},
                                              {"lights", true, 0U},
                                              {"objects", false, 2U},
                                              {"all", true, 2U}}) {
    Scene scene = plain;
    const auto animation = make_flythrough(scene, parse_perturbation(name), kExtent);
    const SceneState state = animation->state(4);
    EXPECT_EQ(state.lights.rects[0].radiance != plain.lights.rects[0].radiance, lights) << name;
    EXPECT_EQ(state.poses.size(), objects) << name;
    EXPECT_EQ(scene.instances.size(), plain.instances.size() + objects) << name;
  }
}

TEST(Flythrough, IsTheSameEveryTime) {
  Scene a = make_builtin_scene("cornell"), b = a;
  const auto first = make_flythrough(a, Perturbation::kAll, kExtent);
  const auto second = make_flythrough(b, Perturbation::kAll, kExtent);
  for (const int frame : {-31, 0, 17, 1000}) {
    EXPECT_EQ(first->state(frame).camera, second->state(frame).camera);
    EXPECT_EQ(first->state(frame).poses, second->state(frame).poses);
    EXPECT_EQ(first->state(frame).lights.rects[0].half_v,
              second->state(frame).lights.rects[0].half_v);
  }
}

TEST(Flythrough, RefusesScenesWithoutKeysOrTriangles) {
  Scene scene = make_builtin_scene("cornell");
  scene.camera_path.clear();
  EXPECT_THROW((void)make_flythrough(scene, Perturbation::kNone, kExtent), std::invalid_argument);
  scene = make_builtin_scene("cornell");
  scene.instances.clear();
  EXPECT_THROW((void)make_flythrough(scene, Perturbation::kNone, kExtent), std::invalid_argument);
}

TEST(Flythrough, UnknownPerturbationListsTheKnownOnes) {
  try {
    (void)parse_perturbation("wind");
    FAIL() << "expected an exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("none, lights, objects or all"));
  }
}

}  // namespace
}  // namespace eigenlight
