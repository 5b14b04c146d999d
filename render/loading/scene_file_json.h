// Reads scene.json, which adds camera and lights to a model. scene_file*.cpp are the only files of
// render/ that include nlohmann JSON.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Checked content of a scene.json; the model is not read yet.
struct SceneDescription {
  std::string name, title;
  std::filesystem::path model;  ///< in the folder of scene.json
  std::vector<CameraKey> camera_path;
  float fov_y = 45.0f;
  glm::vec3 up{0, 1, 0};
  float exposure = 1.0f;
  Lights lights;
  std::map<std::string, glm::vec3> emissive_materials;  ///< material name to radiance
  std::vector<std::string> thin_glass_materials;
  std::filesystem::path environment;  ///< empty: none
  float environment_scale = 1.0f;
};

/// Name of a scene file in messages: folder and file name, e.g. "crytek-sponza/scene.json".
[[nodiscard]] std::string short_name(const std::filesystem::path& path);

/// Reads and checks a scene.json. Throws std::runtime_error with one line: file, field and what was
/// expected, as in "crytek-sponza/scene.json: camera.keyframes[2].eye: expected 3 numbers".
[[nodiscard]] SceneDescription read_scene_json(const std::filesystem::path& path);

}  // namespace eigenlight
