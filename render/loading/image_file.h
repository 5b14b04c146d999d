// Images that scenes need, from files or from memory. image_file.cpp is the only file of render/
// that includes OpenImageIO.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "render/scene/scene.h"

namespace eigenlight {

/// Reads a base color image (PNG, JPEG, TGA, ...): 8-bit sRGB, top row first. Grey images get three
/// equal channels, images without alpha are opaque. Throws std::runtime_error naming the file and
/// the reason.
[[nodiscard]] Texture read_texture(const std::filesystem::path& path);

/// The same from the bytes of an image file, as .glb models embed them; `name` stands for the file.
[[nodiscard]] Texture read_texture(std::span<const std::uint8_t> bytes, const std::string& name);

/// Reads an equirectangular radiance map (.hdr, .exr) and multiplies it by `scale`. Throws
/// std::runtime_error naming the file and the reason; also on NaN, Inf or negative radiance.
[[nodiscard]] Environment read_environment(const std::filesystem::path& path, float scale);

}  // namespace eigenlight
