// The pictures of the page of a run.
#pragma once

#include <filesystem>
#include <vector>

#include "sequences/pages/split_gallery.h"

namespace eigenlight {

/// A split gallery of `frames` of the run in `dir`: `noisy` and `denoised`, each as `full picture`
/// and as `indirect light`. Pictures whose layers the EXR files lack are left out, and so are
/// frames without a file; the gallery has no frames if nothing is left. Throws std::runtime_error
/// naming a file that cannot be read.
[[nodiscard]] PageGallery run_pictures(const std::filesystem::path& dir,
                                       const std::vector<int>& frames,
                                       const PictureOptions& options);

}  // namespace eigenlight
