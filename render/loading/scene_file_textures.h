// Reads the materials of a model and their images. Only for scene_file*.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/scene/scene.h"

struct aiScene;

namespace eigenlight {

struct ModelFile {
  const aiScene& model;
  const std::filesystem::path& path;
};

/// Appends all materials of the model in their order, and their base color images. Reads an image
/// once even if several materials share it. Returns the texture coordinate channel of each
/// material.
[[nodiscard]] std::vector<unsigned> read_materials(const ModelFile& file, Scene& scene,
                                                   std::vector<std::string>& notes);

}  // namespace eigenlight
