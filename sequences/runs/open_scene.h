// Scenes by the names that users give them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

struct SceneRequest {
  std::string name;  ///< built-in name, scene.json (or its directory), or .gltf, .glb, .obj
  bool use_environment = false;
};

/// Adds a line to `notes` for each thing that was made up or left out. Throws std::invalid_argument
/// listing the built-in scenes if `name` is neither a built-in scene nor a file, std::runtime_error
/// naming the file if it cannot be read.
[[nodiscard]] Scene open_scene(const SceneRequest& request, std::vector<std::string>& notes);

/// Throws what open_scene() throws of a name: std::invalid_argument if it is neither a built-in
/// scene nor a file, or if a built-in one is asked for its environment map; BadFile if there is no
/// such file. Reads nothing.
void check_scene(const SceneRequest& request);

/// XXH3-64 of the content of a scene, so that a run is not resumed with another scene.
[[nodiscard]] std::uint64_t scene_hash(const Scene& scene);

}  // namespace eigenlight
