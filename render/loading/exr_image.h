// Pictures in OpenEXR files, through sequences/exr.
#pragma once

#include <filesystem>

#include "frame/plane.h"

namespace eigenlight {

struct ExrImage {
  Planes<3> color;     ///< linear; the data window, top row first
  Plane<float> alpha;  ///< empty without channel A
};

/// Whether the file begins as OpenEXR files do. False if it cannot be read.
[[nodiscard]] bool is_exr_file(const std::filesystem::path& path);

/// Bare R, G, B, else those of the first layer that has all three. Throws std::runtime_error with
/// the file and the reason: no such channels, or a file that cannot be decoded.
[[nodiscard]] ExrImage read_exr_image(const std::filesystem::path& path);

}  // namespace eigenlight
