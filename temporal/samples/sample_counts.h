// Which raw samples a method may use, and how many pixels have which.
#pragma once

#include <cmath>

#include "temporal/denoiser.h"

namespace eigenlight {

/// Pixels of a frame or a part of it.
struct SampleCounts {
  std::int64_t surface = 0;
  std::int64_t fresh = 0;       ///< surfaces without history; the method's to count
  std::int64_t non_finite = 0;  ///< surfaces with NaN or Inf in any channel

  /// Counts a pixel. Returns whether its sample is usable: on a surface, and finite.
  bool take(const FrameInput& frame, int x, int y) {
    if (frame.surface.id(x, y) == 0) return false;
    const auto& u = frame.lights[0].radiance;
    const bool finite =
        std::isfinite(u[0](x, y)) && std::isfinite(u[1](x, y)) && std::isfinite(u[2](x, y));
    ++surface;
    non_finite += finite ? 0 : 1;
    return finite;
  }
  void add_to(FrameReport& report) const {
    report.surface_pixels += surface;
    report.new_pixels += fresh;
    report.non_finite_pixels += non_finite;
  }
};

}  // namespace eigenlight
