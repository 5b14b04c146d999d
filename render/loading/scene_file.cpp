#include "render/loading/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <stdexcept>

#include "render/loading/image_file.h"
#include "render/loading/scene_file_json.h"
#include "render/loading/scene_file_model.h"

namespace eigenlight {
namespace {

/// Returns all materials called `name`. Throws if there is none; `field` is the place in
/// scene.json.
std::vector<Material*> find_materials(Scene& scene, const std::string& name,
                                      const std::string& field) {
  std::vector<Material*> found;
  for (Material& material : scene.materials) {
    if (material.name == name) found.push_back(&material);
  }
  if (found.empty()) {
    throw std::runtime_error(fmt::format("{}: no material \"{}\" in the model", field, name));
  }
  return found;
}

/// Takes radiances from scene.json only, because assimp reads the color of emission but not its
/// strength.
void apply_emission(const SceneDescription& description, const std::string& file, Scene& scene,
                    std::vector<std::string>& notes) {
  for (Material& material : scene.materials) {
    const bool listed = description.emissive_materials.contains(material.name);
    if (material.emission != glm::vec3(0.0f) && !listed) {
      notes.push_back(fmt::format(
          "material \"{}\" emits in the model, but stays dark: {} lists no radiance for it",
          material.name, file));
    }
    material.emission = glm::vec3(0.0f);
  }
  for (const auto& [name, radiance] : description.emissive_materials) {
    for (Material* m : find_materials(scene, name, file + ": lights")) m->emission = radiance;
  }
}

void apply_environment(const SceneDescription& description, const std::string& file, Scene& scene) {
  if (description.environment.empty()) {
    throw std::runtime_error(fmt::format("{}: environment: missing", file));
  }
  scene.environment = read_environment(description.environment, description.environment_scale);
  scene.lights.suns.clear();
  scene.lights.sky = glm::vec3(0.0f);
}

Scene load_described(const std::filesystem::path& path, const SceneFileOptions& options,
                     std::vector<std::string>& notes) {
  const SceneDescription description = read_scene_json(path);
  const std::string file = short_name(path);
  Scene scene;
  scene.name = description.name;
  scene.title = description.title;
  scene.camera_path = description.camera_path;
  scene.fov_y = description.fov_y;
  scene.up = description.up;
  scene.exposure = description.exposure;
  scene.lights = description.lights;
  load_model(description.model, scene, notes);
  apply_emission(description, file, scene, notes);
  for (const std::string& name : description.thin_glass_materials) {
    for (Material* m : find_materials(scene, name, file + ": thin_glass_materials")) {
      m->thin_glass = true;
    }
  }
  if (options.use_environment) apply_environment(description, file, scene);
  return scene;
}

struct Sphere {
  glm::vec3 center;
  float radius;
};

Sphere bounds(const Scene& scene) {
  glm::vec3 lower(std::numeric_limits<float>::infinity()), upper(-lower);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    for (const glm::uvec3& t : mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const glm::vec3 p(instance.to_world * glm::vec4(mesh.positions[t[k]], 1.0f));
        lower = min(lower, p);
        upper = max(upper, p);
      }
    }
  }
  return {(lower + upper) * 0.5f, distance(lower, upper) * 0.5f};
}

/// Adds a camera path: a third of a turn around the model in 8 seconds, from 15 degrees above.
void add_orbit(Scene& scene) {
  const Sphere sphere = bounds(scene);
  const float distance = 1.05f * sphere.radius / std::sin(glm::radians(scene.fov_y) * 0.5f);
  const float height = std::sin(glm::radians(15.0f)), side = std::cos(glm::radians(15.0f));
  constexpr int kKeys = 9;
  for (int i = 0; i < kKeys; ++i) {
    const float turn = static_cast<float>(i) / (kKeys - 1) * glm::two_pi<float>() / 3.0f;
    const glm::vec3 away(side * std::sin(turn), height, side * std::cos(turn));
    scene.camera_path.push_back(
        {static_cast<float>(i), sphere.center + away * distance, sphere.center});
  }
}

Scene load_bare(const std::filesystem::path& path, const SceneFileOptions& options,
                std::vector<std::string>& notes) {
  if (options.use_environment) {
    throw std::runtime_error(fmt::format(
        "{}: a bare model has no environment, expected a scene.json", short_name(path)));
  }
  Scene scene;
  scene.name = scene.title = path.stem().string();
  load_model(path, scene, notes);
  add_orbit(scene);
  // A white surface that faces this sun has a brightness of about 1 at exposure 1.
  scene.lights.suns.push_back({glm::normalize(glm::vec3(0.4f, 1.0f, 0.5f)), {3.0f, 2.8f, 2.5f}});
  scene.lights.sky = {0.4f, 0.5f, 0.65f};
  notes.push_back(
      fmt::format("{}: bare model: added an orbit camera, a sun and a sky", short_name(path)));
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& path, const SceneFileOptions& options,
                 std::vector<std::string>& notes) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".json") return load_described(path, options, notes);
  if (extension == ".gltf" || extension == ".glb" || extension == ".obj") {
    return load_bare(path, options, notes);
  }
  throw std::runtime_error(fmt::format(
      "{}: unknown kind of scene, expected scene.json, .gltf, .glb or .obj", path.string()));
}

}  // namespace eigenlight
