// Helpers shared by the built-in scenes, which builtin_scenes.h lists.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <utility>

#include "render/scene/scene.h"

namespace eigenlight {

[[nodiscard]] Scene make_cornell();
[[nodiscard]] Scene make_atrium();
[[nodiscard]] Scene make_gallery();

/// Adds a material of one linear color and returns its index.
[[nodiscard]] int add_material(Scene& scene, const std::string& name, const glm::vec3& color);
/// Adds a material with a texture and returns its index.
[[nodiscard]] int add_material(Scene& scene, Texture texture);

/// Adds a mesh for place() and returns its index.
[[nodiscard]] int add_mesh(Scene& scene, Mesh mesh);
/// Adds an instance of a mesh at `position`, turned by `degrees` about the y axis.
void place(Scene& scene, int mesh, const glm::vec3& position, float degrees = 0.0f);
/// Adds a mesh and one instance of it with the identity transform.
void place_once(Scene& scene, Mesh mesh);

}  // namespace eigenlight
