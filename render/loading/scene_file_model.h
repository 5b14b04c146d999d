// Reads model files (glTF, OBJ) with assimp. scene_file*.cpp are the only files that include
// assimp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Appends the meshes, instances, materials and textures of a model to `scene`. Coordinates and
/// emission are those of the model. Updates Scene::missing_textures and `notes` as load_scene()
/// describes. Throws std::runtime_error with the file name if the file cannot be read or has no
/// triangle.
void load_model(const std::filesystem::path& path, Scene& scene, std::vector<std::string>& notes);

}  // namespace eigenlight
