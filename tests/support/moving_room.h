// A small room with a moving plate and camera, for tests of rendered sequences.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/scenes.h"

namespace eigenlight::test {

inline RenderOptions small_options() {
  RenderOptions o;
  o.extent = {40, 24};
  o.spp = 2;
  o.direct_spp = 2;
  return o;
}

/// A room without a front wall, with a lamp and a plate that moving_animation() moves.
inline Scene moving_scene() {
  Scene scene;
  add_material(scene, {0.7f, 0.6f, 0.5f});
  add_material(scene, {0.2f, 0.8f, 0.3f});
  add_floor(scene, 0, 3.0f, -1.0f);
  add_floor(scene, 0, 3.0f, 1.0f);
  add_quad(scene, 0, {glm::vec3(-3, -1, 3), glm::vec3(6, 0, 0), glm::vec3(0, 1.5f, 0)});
  add_quad(scene, 1, {glm::vec3(-0.4f, -0.4f, 0), glm::vec3(0.8f, 0, 0), glm::vec3(0, 0.8f, 0)});
  scene.lights.sky = glm::vec3(0.5f);
  scene.lights.rects = {{{0, 0.9f, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}, {3, 3, 3}}};
  return scene;
}

inline Camera camera_at(const glm::vec3& eye, Extent extent) {
  return look_at(eye, eye + glm::vec3(0, 0, 1), {0, 1, 0}, 60.0f, extent);
}

inline FunctionAnimation moving_animation(const Scene& scene, Extent extent) {
  return FunctionAnimation([lights = scene.lights, extent](int frame) {
    const auto t = static_cast<float>(frame);
    const glm::vec3 place(0.05f * t, 0.02f * t, 1.0f - 0.03f * t);
    return SceneState{
        camera_at({0.04f * t, 0, -2}, extent), lights, {glm::translate(glm::mat4(1.0f), place)}};
  });
}

/// The frame after `n` others.
inline Frame nth(LiveSource& source, int n) {
  Frame frame;
  for (int i = 0; i <= n; ++i) {
    if (!source.next(frame)) throw std::logic_error("sequence too short");
  }
  return frame;
}

/// Expects the same bits in all planes that the renderer fills.
inline void expect_same(const Frame& a, const Frame& b) {
  EXPECT_TRUE(same_bits(a.lights[0].radiance, b.lights[0].radiance));
  EXPECT_TRUE(same_bits(a.direct, b.direct));
  EXPECT_TRUE(same_bits(a.emission, b.emission));
  EXPECT_TRUE(same_bits(a.motion, b.motion));
  EXPECT_TRUE(same_bits(a.surface.albedo, b.surface.albedo));
  EXPECT_TRUE(same_bits(a.surface.normal, b.surface.normal));
  EXPECT_EQ(a.rays, b.rays);
}

}  // namespace eigenlight::test
