// scene.json: what stands beside a model. scene_file*.cpp are the only files of render/ that
// include nlohmann JSON.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Everything scene.json says, checked; the model is not yet read.
struct SceneDescription {
  std::string name, title;
  std::filesystem::path model;  ///< beside the scene.json
  std::vector<CameraKey> camera_path;
  float fov_y = 45.0f;
  glm::vec3 up{0, 1, 0};
  float exposure = 1.0f;
  Lights lights;
  std::map<std::string, glm::vec3> emissive_materials;  ///< radiance by material name
  std::vector<std::string> thin_glass_materials;
  std::filesystem::path environment;  ///< empty: none
  float environment_scale = 1.0f;
};

/// Name of a scene file in messages: its folder and its name, e.g. "crytek-sponza/scene.json".
[[nodiscard]] std::string short_name(const std::filesystem::path& path);

/// Throws std::runtime_error with one line naming file, field and what was expected, as in
/// "crytek-sponza/scene.json: camera.keyframes[2].eye: expected 3 numbers".
[[nodiscard]] SceneDescription read_scene_json(const std::filesystem::path& path);

}  // namespace eigenlight
