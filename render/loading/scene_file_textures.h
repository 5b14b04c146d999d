// Materials of a model and the images they use. Internal to scene_file*.cpp.
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

/// Appends all materials of the model, in its order, and the base color images they use; an image
/// that several materials share is read once. Returns the texture coordinate channel of each.
[[nodiscard]] std::vector<unsigned> read_materials(const ModelFile& file, Scene& scene,
                                                   std::vector<std::string>& notes);

}  // namespace eigenlight
