#include "render/builtin/builtin_scenes.h"

#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "frame/named.h"
#include "render/builtin/builtin_parts.h"

namespace eigenlight {

const std::vector<BuiltinScene>& builtin_scenes() {
  static const std::vector<BuiltinScene> scenes{
      {"cornell", "the Cornell box: colored walls, two blocks, a lamp", make_cornell},
      {"atrium", "a sunlit court with two storeys of arcades, banners and a fountain", make_atrium},
      {"gallery", "a picture gallery under skylights, and a red room behind a doorway",
       make_gallery}};
  return scenes;
}

Scene make_builtin_scene(std::string_view name) {
  return find_named(builtin_scenes(), name, "scene").make();
}

int add_material(Scene& scene, const std::string& name, const glm::vec3& color) {
  Material material;
  material.name = name;
  material.base_color = color;
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

int add_material(Scene& scene, Texture texture) {
  const int index = add_material(scene, texture.name, glm::vec3(1.0f));
  scene.materials.back().texture = static_cast<int>(scene.textures.size());
  scene.textures.push_back(std::move(texture));
  return index;
}

int add_mesh(Scene& scene, Mesh mesh) {
  scene.meshes.push_back(std::move(mesh));
  return static_cast<int>(scene.meshes.size()) - 1;
}

void place(Scene& scene, int mesh, const glm::vec3& position, float degrees) {
  const glm::mat4 move = glm::translate(glm::mat4(1.0f), position);
  scene.instances.push_back({mesh, glm::rotate(move, glm::radians(degrees), {0, 1, 0})});
}

void place_once(Scene& scene, Mesh mesh) {
  place(scene, add_mesh(scene, std::move(mesh)), glm::vec3(0.0f));
}

}  // namespace eigenlight
