// The pictures of the report page.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace eigenlight {

struct PictureOptions {
  float exposure = 1.0f;             ///< factor before the sRGB curve
  float frames_per_second = 24.0f;   ///< of the sequence
  std::size_t max_frames = 240;      ///< more are thinned evenly
  std::size_t max_bytes = 17500000;  ///< of all JPEG files together, before base64 adds a third
};

/// For the page's script: width, height, fps, note, frames (those shown), and kinds {beauty,
/// indirect} of {denoised, noisy}, lists of data URIs beside `frames`. Kinds and sides that the
/// layers of the first file do not allow are left out; pixels with NaN or Inf are magenta. Frames
/// without a file are left out. Throws std::runtime_error naming a file that cannot be read.
[[nodiscard]] nlohmann::ordered_json report_pictures(const std::filesystem::path& dir,
                                                     const std::vector<int>& frames,
                                                     const PictureOptions& options);

}  // namespace eigenlight
