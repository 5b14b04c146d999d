#include "sequences/runs/open_scene.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "frame/bad_file.h"
#include "frame/check.h"
#include "frame/named.h"
#include "render/builtin/builtin_scenes.h"
#include "render/loading/scene_file.h"

namespace eigenlight {
namespace {

// Hashes values one by one, because structs have padding.
class SceneHash {
 public:
  SceneHash() { XXH3_64bits_reset(state_.get()); }

  template <typename T>
  requires std::is_arithmetic_v<T>
  void add(T value) { bytes(&value, sizeof(value)); }
  void add(const glm::vec3& v) { bytes(&v, sizeof(v)); }
  void add(const glm::mat4& m) { bytes(&m, sizeof(m)); }
  template <typename T>
  void add(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(values.size());
    bytes(values.data(), values.size() * sizeof(T));
  }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

 private:
  void bytes(const void* data, std::size_t size) { XXH3_64bits_update(state_.get(), data, size); }

  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_{XXH3_createState(),
                                                                  XXH3_freeState};
};

// Structs that are hashed as bytes have no padding.
static_assert(sizeof(SunLight) == 28 && sizeof(AreaRect) == 48 && sizeof(SphereLight) == 28 &&
              sizeof(CameraKey) == 28 && sizeof(Instance) == 68);

void add_surfaces(const Scene& scene, SceneHash& hash) {
  for (const Mesh& mesh : scene.meshes) {
    hash.add(mesh.positions);
    hash.add(mesh.normals);
    hash.add(mesh.texcoords);
    hash.add(mesh.triangles);
    hash.add(mesh.material);
  }
  hash.add(scene.instances);
  for (const Material& material : scene.materials) {
    hash.add(material.base_color);
    hash.add(material.texture);
    hash.add(material.alpha_cutoff);
    hash.add(material.thin_glass);
    hash.add(material.emission);
  }
  for (const Texture& texture : scene.textures) {
    hash.add(texture.extent.width);
    hash.add(texture.rgba);
  }
}

void add_lights(const Scene& scene, SceneHash& hash) {
  const Lights& lights = scene.lights;
  hash.add(lights.suns);
  hash.add(lights.sky);
  hash.add(lights.rects);
  hash.add(lights.spheres);
  hash.add(lights.environment_scale);
  hash.add(lights.emissive_scale);
  hash.add(lights.emissive_tilt);
  if (scene.environment) {
    hash.add(scene.environment->extent.width);
    hash.add(scene.environment->radiance);
  }
}

[[noreturn]] void fail_unknown(const std::string& name) {
  throw std::invalid_argument(
      fmt::format("unknown scene '{}'; built-in: {}; or give a scene.json, .gltf, .glb or .obj "
                  "file",
                  name, names_of(builtin_scenes())));
}

bool names_a_file(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".json" || extension == ".gltf" || extension == ".glb" || extension == ".obj";
}

const BuiltinScene* find_builtin(const std::string& name) {
  const auto& built_in = builtin_scenes();
  const auto found = std::find_if(built_in.begin(), built_in.end(),
                                  [&](const BuiltinScene& scene) { return scene.name == name; });
  return found == built_in.end() ? nullptr : &*found;
}

std::filesystem::path file_of(const std::string& name) {
  std::filesystem::path path = name;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) path /= "scene.json";
  if (!names_a_file(path)) fail_unknown(name);
  return path;
}

}  // namespace

void check_scene(const SceneRequest& request) {
  if (find_builtin(request.name)) {
    EL_CHECK(!request.use_environment,
             "--environment: the built-in scene '{}' has no environment map", request.name);
    return;
  }
  const std::filesystem::path path = file_of(request.name);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw BadFile(fmt::format("{}: no such file", path.string()));
  }
}

Scene open_scene(const SceneRequest& request, std::vector<std::string>& notes) {
  check_scene(request);
  if (const BuiltinScene* builtin = find_builtin(request.name)) return builtin->make();
  return load_scene(file_of(request.name), {request.use_environment}, notes);
}

std::uint64_t scene_hash(const Scene& scene) {
  SceneHash hash;
  add_surfaces(scene, hash);
  add_lights(scene, hash);
  hash.add(scene.camera_path);
  hash.add(scene.fov_y);
  hash.add(scene.up);
  return hash.value();
}

}  // namespace eigenlight
