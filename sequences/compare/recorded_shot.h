// Frames that another renderer wrote, in place of scenes.
#pragma once

#include <string>

#include "sequences/denoise/denoise_run.h"

namespace eigenlight {

struct RecordedShot {
  DenoiseSettings denoise;  ///< as `eigenlight denoise` takes them
  /// Patterns, perhaps with what layers begin with (LayerSequence); the second is empty if there is
  /// none.
  std::string reference, reference_b;
  std::string layer = "color";  ///< that is measured, in outputs and references; `color`: beauty
};

}  // namespace eigenlight
