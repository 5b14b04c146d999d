// Frames on their way from the reader to the denoiser.
#pragma once

#include <memory>
#include <vector>

#include "frame/frame.h"
#include "sequences/denoise/raw_frame.h"

namespace eigenlight {

/// A frame that was read and converted, for each view.
struct ReadyFrame {
  std::shared_ptr<const RawFrame> raw;
  std::vector<std::unique_ptr<Frame>> views;
  double read_ms = 0.0;  ///< wall clock
};

}  // namespace eigenlight
