// The pictures of the page of a run of `denoise`.
#pragma once

#include "sequences/denoise/denoise_run.h"
#include "sequences/pages/page.h"

namespace eigenlight {

/// A split gallery of all frames: the beauty, and each layer of light that was denoised, of all
/// views. Shown with the exposure that suits the first denoised picture (auto_exposure.h). Throws
/// BadFile and std::runtime_error naming a file that cannot be read.
[[nodiscard]] PageGallery denoise_pictures(const DenoisePlan& plan);

}  // namespace eigenlight
