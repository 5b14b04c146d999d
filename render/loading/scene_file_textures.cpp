#include "render/loading/scene_file_textures.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>

#include "frame/tiles.h"
#include "render/loading/image_file.h"

namespace eigenlight {
namespace {

/// Linear gray that replaces an image that cannot be read.
constexpr float kMissingGrey = 0.5f;

/// An image of a model, identified by its name.
struct ImageRead {
  std::string name;
  std::optional<Texture> texture;
  std::string error;
};

/// Returns the name of the base color image; empty if there is none.
std::string base_color_image(const aiMaterial& material, unsigned& uv_channel) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString name;
    if (material.GetTexture(type, 0, &name, nullptr, &uv_channel) == aiReturn_SUCCESS) {
      return name.C_Str();
    }
  }
  return {};
}

/// Returns the alpha below which texels are holes.
float alpha_cutoff(const aiMaterial& material) {
  aiString mode;
  float cutoff = 0.5f;  // default of glTF 2.0, 3.9.4
  if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
    if (std::string(mode.C_Str()) == "OPAQUE") return 0.0f;
    material.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
  }
  return cutoff;
}

Material read_material(const aiMaterial& from) {
  Material material;
  material.name = from.GetName().C_Str();
  aiColor4D color(0.5f, 0.5f, 0.5f, 1.0f);
  if (from.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS) {
    from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  }
  material.base_color = clamp(glm::vec3(color.r, color.g, color.b), 0.0f, 1.0f);
  aiColor3D emission(0.0f, 0.0f, 0.0f);
  from.Get(AI_MATKEY_COLOR_EMISSIVE, emission);
  material.emission = max(glm::vec3(emission.r, emission.g, emission.b), 0.0f);
  return material;
}

Texture read_embedded(const aiTexture& image, const std::string& name) {
  if (image.mHeight == 0) {  // pcData holds mWidth bytes of an image file
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(image.pcData);
    return read_texture({bytes, image.mWidth},
                        fmt::format("embedded {}.{}", name, image.achFormatHint));
  }
  Texture texture{name, {static_cast<int>(image.mWidth), static_cast<int>(image.mHeight)}, {}};
  for (std::size_t i = 0; i < texture.extent.pixels(); ++i) {
    const aiTexel& t = image.pcData[i];
    texture.rgba.insert(texture.rgba.end(), {t.r, t.g, t.b, t.a});
  }
  return texture;
}

void read_image(const ModelFile& file, ImageRead& image) {
  try {
    const aiTexture* embedded = file.model.GetEmbeddedTexture(image.name.c_str());
    if (embedded != nullptr) {
      image.texture = read_embedded(*embedded, image.name);
    } else {
      std::string relative = image.name;  // MTL files from Windows have backslashes
      std::replace(relative.begin(), relative.end(), '\\', '/');
      image.texture = read_texture(file.path.parent_path() / relative);
    }
  } catch (const std::runtime_error& error) {
    image.error = error.what();
  }
}

bool has_holes(const Texture& texture, float cutoff) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    if (static_cast<float>(texture.rgba[i]) < cutoff * 255.0f) return true;
  }
  return false;
}

/// Moves the images that could be read to the scene. Returns the index of each texture, or -1.
std::vector<int> add_textures(std::vector<ImageRead>& images, Scene& scene,
                              std::vector<std::string>& notes) {
  std::vector<int> texture_of(images.size(), -1);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].texture) {
      texture_of[i] = static_cast<int>(scene.textures.size());
      scene.textures.push_back(std::move(*images[i].texture));
    } else {
      ++scene.missing_textures;
      notes.push_back(fmt::format("{}; gray replaces it", images[i].error));
    }
  }
  return texture_of;
}

}  // namespace

std::vector<unsigned> read_materials(const ModelFile& file, Scene& scene,
                                     std::vector<std::string>& notes) {
  const std::size_t first = scene.materials.size();
  std::vector<unsigned> uv_channels(file.model.mNumMaterials, 0);
  std::vector<int> image_of(file.model.mNumMaterials, -1);
  std::vector<ImageRead> images;
  std::map<std::string, int> known;
  for (unsigned i = 0; i < file.model.mNumMaterials; ++i) {
    const aiMaterial& material = *file.model.mMaterials[i];
    scene.materials.push_back(read_material(material));
    const std::string name = base_color_image(material, uv_channels[i]);
    if (name.empty()) continue;
    const auto [entry, is_new] = known.try_emplace(name, static_cast<int>(images.size()));
    if (is_new) images.push_back({name, {}, {}});
    image_of[i] = entry->second;
  }
  parallel_for(static_cast<int>(images.size()),
               [&](int i) { read_image(file, images[static_cast<std::size_t>(i)]); });
  const std::vector<int> texture_of = add_textures(images, scene, notes);
  for (unsigned i = 0; i < file.model.mNumMaterials; ++i) {
    if (image_of[i] < 0) continue;
    Material& material = scene.materials[first + i];
    material.texture = texture_of[static_cast<std::size_t>(image_of[i])];
    if (material.texture < 0) {
      material.base_color *= kMissingGrey;
      continue;
    }
    const float cutoff = alpha_cutoff(*file.model.mMaterials[i]);
    const Texture& texture = scene.textures[static_cast<std::size_t>(material.texture)];
    if (has_holes(texture, cutoff)) material.alpha_cutoff = cutoff;
  }
  return uv_channels;
}

}  // namespace eigenlight
