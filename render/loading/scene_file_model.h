// Model files (glTF, OBJ) through assimp. scene_file*.cpp are the only files that include assimp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Appends the meshes, instances, materials and textures of a model to `scene`, in the model's own
/// coordinates; emission is what the model says. Adds to Scene::missing_textures and `notes` what
/// load_scene() promises. Throws std::runtime_error naming the file if it cannot be read or holds
/// no triangle.
void load_model(const std::filesystem::path& path, Scene& scene, std::vector<std::string>& notes);

}  // namespace eigenlight
