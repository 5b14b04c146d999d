// The pictures of the page of a run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "sequences/pages/page.h"

namespace eigenlight {

struct PictureOptions {
  std::string method = {};          ///< named in the caption of the denoised pictures
  float exposure = 1.0f;            ///< factor before the sRGB curve
  double frames_per_second = 24.0;  ///< of the sequence
  std::size_t max_frames = 240;     ///< of more frames only every n-th is shown
  /// Of all JPEG files together. Larger pictures are shrunk by a whole factor. (Base64 adds a third
  /// to the size of the page.)
  std::size_t max_bytes = 17500000;
};

/// A split gallery of `frames` of the run in `dir`: `noisy` and `denoised`, each as `full picture`
/// and as `indirect light`. Pictures whose layers the EXR files lack are left out, and so are
/// frames without a file; the gallery has no frames if nothing is left. Throws std::runtime_error
/// naming a file that cannot be read.
[[nodiscard]] PageGallery run_pictures(const std::filesystem::path& dir,
                                       const std::vector<int>& frames,
                                       const PictureOptions& options);

}  // namespace eigenlight
