// 8-bit pictures: PNG and JPEG, through OpenImageIO.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

/// True for the names of 8-bit pictures (png, jpg, jpeg; any case), which hold display values, not
/// radiance.
[[nodiscard]] bool is_ldr_name(const std::filesystem::path& path);

/// Red, green and blue in [0, 1] as stored, still on the display curve; gray is repeated, alpha
/// dropped. Throws std::runtime_error naming the file.
[[nodiscard]] Planes<3> read_ldr_image(const std::filesystem::path& path);

/// A picture of 3 bytes a pixel (channels() == 3) as a JPEG file in memory. `quality` in [1, 100].
/// Throws std::runtime_error if the encoder fails.
[[nodiscard]] std::vector<unsigned char> encode_jpeg(const Plane<std::uint8_t>& rgb, int quality);

/// A JPEG file as a data URI, for a page in one file.
[[nodiscard]] std::string jpeg_data_uri(const std::vector<unsigned char>& jpeg);

}  // namespace eigenlight
