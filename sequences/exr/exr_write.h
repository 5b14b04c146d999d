// New OpenEXR files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>

#include "frame/plane.h"
#include "sequences/exr/exr_file.h"

namespace eigenlight {

/// One channel to write: a plane of floats (half or float in the file) or of integers (kUint).
struct ExrChannel {
  std::string name;  ///< `R`, `albedo.G`
  ExrType type = ExrType::kHalf;
  std::variant<const Plane<float>*, const Plane<std::uint32_t>*> pixels;
};

struct ExrAttribute {
  std::string name;
  std::variant<int, float, std::string, ExrMatrix> value;
};

/// Writes a scanline file, ZIP compressed, with write_file_atomically(), and counts the values that
/// did not fit. NaN and Inf are kept; choose kFloat for a layer with values beyond 65504. Equal
/// input gives equal bytes. Throws std::invalid_argument unless all planes have the same extent,
/// std::runtime_error naming the file if it cannot be written.
ExrOverflow write_exr(const std::filesystem::path& path, std::span<const ExrChannel> channels,
                      std::span<const ExrAttribute> attributes);

}  // namespace eigenlight
