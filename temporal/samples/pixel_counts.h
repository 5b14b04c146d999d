// Counts of pixels with a surface, with history, and with usable samples.
#pragma once

#include <cmath>

#include "temporal/denoiser.h"

namespace eigenlight {

/// Pixels of a frame or a part of it.
struct PixelCounts {
  std::int64_t surface = 0;
  std::int64_t unguided = 0;    ///< surfaces without usable normal or depth
  std::int64_t fresh = 0;       ///< surfaces without history
  std::int64_t non_finite = 0;  ///< surfaces with NaN, Inf or light beyond kLargestLight

  /// Counts a pixel, for methods that take samples as they are. Returns whether its sample is
  /// usable: on a surface, and finite.
  bool add(const FrameInput& frame, int x, int y) {
    if (frame.surface.id(x, y) == 0) return false;
    const Planes<3>& u = frame.lights[0].radiance;
    const bool finite =
        std::isfinite(u[0](x, y)) && std::isfinite(u[1](x, y)) && std::isfinite(u[2](x, y));
    ++surface;
    non_finite += finite ? 0 : 1;
    return finite;
  }
  PixelCounts& operator+=(const PixelCounts& other) {
    surface += other.surface;
    unguided += other.unguided;
    fresh += other.fresh;
    non_finite += other.non_finite;
    return *this;
  }
  void add_to(FrameReport& report) const {
    report.surface_pixels += surface;
    report.unguided_pixels += unguided;
    report.new_pixels += fresh;
    report.non_finite_pixels += non_finite;
  }
};

}  // namespace eigenlight
