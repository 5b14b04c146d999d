// What the files of the built-in scenes share; see builtin_scenes.h for the scenes.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <utility>

#include "render/scene/scene.h"

namespace eigenlight {

[[nodiscard]] Scene make_cornell();
[[nodiscard]] Scene make_atrium();
[[nodiscard]] Scene make_gallery();

/// Index of a new material of one linear color.
[[nodiscard]] int add_material(Scene& scene, const std::string& name, const glm::vec3& color);
/// Index of a new material that shows `texture`.
[[nodiscard]] int add_material(Scene& scene, Texture texture);

/// Adds a mesh, to be placed by place(), and returns its index.
[[nodiscard]] int add_mesh(Scene& scene, Mesh mesh);
/// Places a mesh at `position`, turned by `degrees` about the y axis.
void place(Scene& scene, int mesh, const glm::vec3& position, float degrees = 0.0f);
/// Adds a mesh and places it once, where it was built.
void place_once(Scene& scene, Mesh mesh);

}  // namespace eigenlight
