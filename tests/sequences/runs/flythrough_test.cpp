#include "sequences/runs/flythrough.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>

#include "render/builtin/builtin_scenes.h"
#include "render/rays/embree_scene.h"
#include "render/scene/clearance.h"
#include "sequences/runs/camera_path.h"
#include "sequences/runs/perturb_lights.h"
#include "sequences/runs/perturb_objects.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Extent kExtent{160, 90};

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

TEST(Flythrough, PerturbsOnlyWhatIsAsked) {
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

TEST(Flythrough, LightStepsAtTheGivenFrame) {
  const Scene plain = make_builtin_scene("cornell");
  for (const auto& [text, frame] : {std::pair{"step", 24}, std::pair{"step:7", 7}}) {
    Scene scene = plain;
    const auto animation = make_flythrough(scene, parse_perturbation(text), kExtent);
    const glm::vec3 rest = plain.lights.rects[0].radiance;
    EXPECT_EQ(animation->state(frame - 1).lights.rects[0].radiance, rest) << text;
    EXPECT_EQ(animation->state(frame).lights.rects[0].radiance, kLightStep * rest) << text;
    EXPECT_TRUE(animation->state(frame).poses.empty());
  }
}

TEST(Flythrough, PerturbationsAreParsedAndFormatted) {
  for (const char* text : {"none", "lights", "objects", "all", "step:1", "step:1000000"}) {
    EXPECT_EQ(format_perturbation(parse_perturbation(text)), text);
  }
  EXPECT_EQ(format_perturbation(parse_perturbation("step")), "step:24");
  for (const char* text : {"", "step:", "step:0", "step:-3", "step:1000001", "step:4x",
                           "step:99999999999999999999", "lights:3", "Step", ":"}) {
    EXPECT_THROW((void)parse_perturbation(text), std::invalid_argument) << text;
  }
}

TEST(Flythrough, StatesDependOnTheFrameNumberAlone) {
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

TEST(Flythrough, SceneWithoutKeysOrTrianglesIsAnError) {
  Scene scene = make_builtin_scene("cornell");
  scene.camera_path.clear();
  EXPECT_THROW((void)make_flythrough(scene, Perturbation::kNone, kExtent), std::invalid_argument);
  scene = make_builtin_scene("cornell");
  scene.instances.clear();
  EXPECT_THROW((void)make_flythrough(scene, Perturbation::kNone, kExtent), std::invalid_argument);
}

TEST(Flythrough, UnknownPerturbationListsKnownOnes) {
  try {
    (void)parse_perturbation("wind");
    FAIL() << "expected an exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("none, lights, objects, all, step, step:FRAME"));
  }
}

}  // namespace
}  // namespace eigenlight
