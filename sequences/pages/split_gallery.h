// Two pictures of each frame, one left and one right of a divider.
#pragma once

#include <cstddef>
#include <functional>
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

/// One picture of a frame.
struct SplitView {
  std::size_t kind = 0;  ///< index into SplitPictures::kinds
  bool is_denoised = false;
  Planes<3> colors;
};

/// Where the pictures come from.
struct SplitPictures {
  std::vector<std::string> kinds;
  /// All pictures of a frame; the same ones for each frame, of one size.
  std::function<std::vector<SplitView>(int frame)> read;
};

/// A split gallery of `frames`: `noisy` and `denoised` of each kind that there are pictures of. It
/// has no frames if nothing is left. Throws what read() throws.
[[nodiscard]] PageGallery split_gallery(const std::vector<int>& frames,
                                        const SplitPictures& pictures,
                                        const PictureOptions& options);

}  // namespace eigenlight
