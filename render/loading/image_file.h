// Reads textures and environment maps from files or memory: OpenEXR through sequences/exr, all else
// through OpenImageIO, which no other file of render/ includes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "render/scene/scene.h"

namespace eigenlight {

/// Reads a base color image (PNG, JPEG, TGA, ...) as 8-bit sRGB with the top row first. Gray images
/// get three equal channels; images without alpha are opaque; EXR is linear and is encoded as sRGB.
/// Throws std::runtime_error with the file and the reason.
[[nodiscard]] Texture read_texture(const std::filesystem::path& path);

/// Reads the bytes of an image file, which .glb models embed. Error messages call it `name`.
[[nodiscard]] Texture read_texture(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads an equirectangular radiance map (.hdr, .exr) and multiplies it by `scale`. Throws
/// std::runtime_error with the file and the reason, also if a radiance is negative, NaN or Inf.
[[nodiscard]] Environment read_environment(const std::filesystem::path& path, float scale);

}  // namespace eigenlight
