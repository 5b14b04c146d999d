#include "render/scene/scene_check.h"

#include "frame/check.h"

namespace eigenlight {
namespace {

void check_index(const std::string& what, int index, std::size_t count) {
  EL_CHECK(index >= 0 && static_cast<std::size_t>(index) < count,
           "{} {}: expected an index below {}", what, index, count);
}

void check_mesh(const Scene& scene, const Mesh& mesh) {
  const std::string name = "mesh '" + mesh.name + "': ";
  check_index(name + "material", mesh.material, scene.materials.size());
  const std::size_t vertices = mesh.positions.size();
  EL_CHECK(mesh.normals.empty() || mesh.normals.size() == vertices,
           "{}{} normals for {} positions: expected one each, or none", name, mesh.normals.size(),
           vertices);
  EL_CHECK(mesh.texcoords.empty() || mesh.texcoords.size() == vertices,
           "{}{} texcoords for {} positions: expected one each, or none", name,
           mesh.texcoords.size(), vertices);
  for (const glm::uvec3& t : mesh.triangles) {
    EL_CHECK(t.x < vertices && t.y < vertices && t.z < vertices,
             "{}triangle ({}, {}, {}): expected indices below {}", name, t.x, t.y, t.z, vertices);
  }
}

}  // namespace

void check_scene(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) check_mesh(scene, mesh);
  for (const Instance& instance : scene.instances) {
    check_index("instance: mesh", instance.mesh, scene.meshes.size());
  }
  for (const Material& material : scene.materials) {
    if (material.texture == -1) continue;
    check_index("material '" + material.name + "': texture", material.texture,
                scene.textures.size());
  }
  for (const Texture& texture : scene.textures) {
    check_extent(texture.extent);
    EL_CHECK(texture.rgba.size() == 4 * texture.extent.pixels(),
             "texture '{}': {} bytes for {}x{} pixels: expected 4 each", texture.name,
             texture.rgba.size(), texture.extent.width, texture.extent.height);
  }
  if (scene.environment) {
    check_extent(scene.environment->extent);
    EL_CHECK(scene.environment->radiance.size() == scene.environment->extent.pixels(),
             "environment: {} values for {}x{} pixels: expected one each",
             scene.environment->radiance.size(), scene.environment->extent.width,
             scene.environment->extent.height);
  }
}

}  // namespace eigenlight
