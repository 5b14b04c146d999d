#include <array>

#include "render/builtin/builtin_parts.h"
#include "render/scene/mesh_builder.h"

namespace eigenlight {
namespace {

using Corners = std::array<glm::vec2, 4>;

/// A block on the floor: its four corners (x, z) in order, and its height.
Mesh block(const std::string& name, const Corners& foot, float height, int material) {
  MeshBuilder builder;
  const auto at = [&](std::size_t i, float y) {
    return glm::vec3(foot[i % 4].x, y, foot[i % 4].y);
  };
  for (std::size_t i = 0; i < 4; ++i) {
    builder.quad(at(i, 0), at(i + 1, 0), at(i + 1, height), at(i, height));
  }
  builder.quad(at(0, height), at(1, height), at(2, height), at(3, height));
  return builder.take(name, material);
}

void add_walls(Scene& scene) {
  const int white = add_material(scene, "white", {0.725f, 0.71f, 0.68f});
  const int red = add_material(scene, "red", {0.63f, 0.065f, 0.05f});
  const int green = add_material(scene, "green", {0.14f, 0.45f, 0.091f});
  constexpr float kWidth = 5.56f, kHeight = 5.488f, kDepth = 5.592f;
  MeshBuilder builder;
  builder.quad({0, 0, kDepth}, {kWidth, 0, kDepth}, {kWidth, 0, 0}, {0, 0, 0});
  builder.quad({0, kHeight, 0}, {kWidth, kHeight, 0}, {kWidth, kHeight, kDepth},
               {0, kHeight, kDepth});
  builder.quad({kWidth, 0, kDepth}, {0, 0, kDepth}, {0, kHeight, kDepth},
               {kWidth, kHeight, kDepth});
  place_once(scene, builder.take("room", white));
  builder.quad({kWidth, 0, 0}, {kWidth, 0, kDepth}, {kWidth, kHeight, kDepth},
               {kWidth, kHeight, 0});
  place_once(scene, builder.take("red wall", red));
  builder.quad({0, 0, kDepth}, {0, 0, 0}, {0, kHeight, 0}, {0, kHeight, kDepth});
  place_once(scene, builder.take("green wall", green));

  const Corners low{{{1.30f, 0.65f}, {0.82f, 2.25f}, {2.40f, 2.72f}, {2.90f, 1.14f}}};
  const Corners tall{{{4.23f, 2.47f}, {2.65f, 2.96f}, {3.14f, 4.56f}, {4.72f, 4.06f}}};
  place_once(scene, block("short block", low, 1.65f, white));
  place_once(scene, block("tall block", tall, 3.30f, white));
}

/// Adds the lamp, far enough below the ceiling to tilt.
void add_lamp(Scene& scene) {
  scene.lights.rects.push_back(
      {{2.78f, 5.28f, 2.795f}, {0.65f, 0, 0}, {0, 0, 0.525f}, {17.0f, 12.0f, 4.0f}});
}

}  // namespace

/// The Cornell box in decimeters. Room, blocks, lamp and colors follow the data of the Cornell
/// Program of Computer Graphics (1998), with spectra converted to RGB.
Scene make_cornell() {
  Scene scene;
  scene.name = "cornell";
  scene.title = "Cornell box";
  add_walls(scene);
  add_lamp(scene);
  scene.exposure = 1.6f;
  scene.fov_y = 45.0f;
  // The path leads from the open front past the short block to a high corner, and down behind the
  // tall block.
  scene.camera_path = {{0.0f, {2.78f, 2.73f, -4.2f}, {2.78f, 2.6f, 2.8f}},
                       {1.5f, {1.9f, 3.0f, -0.6f}, {2.9f, 2.1f, 2.9f}},
                       {3.0f, {0.7f, 3.6f, 0.6f}, {3.3f, 1.3f, 3.2f}},
                       {4.5f, {0.8f, 3.9f, 3.2f}, {3.4f, 1.2f, 2.6f}},
                       {6.0f, {1.6f, 3.2f, 4.6f}, {3.2f, 1.3f, 1.8f}}};
  return scene;
}

}  // namespace eigenlight
