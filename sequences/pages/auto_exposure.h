// How bright to show pictures whose exposure nobody said.
#pragma once

#include <cmath>

#include "frame/plane.h"

namespace eigenlight {

/// The power of two, 2^-20 to 2^20, that brings the logarithmic mean of the luminance (Rec. 709,
/// pixels above 0 only) nearest to middle gray, 0.18. 1 for a black picture. Steps of a factor of
/// two keep the exposure of most pictures at 1.
[[nodiscard]] inline float auto_exposure(const Planes<3>& picture) {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < picture[0].height(); ++y) {
    for (int x = 0; x < picture[0].width(); ++x) {
      const double light = 0.2126 * static_cast<double>(picture[0](x, y)) +
                           0.7152 * static_cast<double>(picture[1](x, y)) +
                           0.0722 * static_cast<double>(picture[2](x, y));
      if (!std::isfinite(light) || !std::isgreater(light, 1e-6)) continue;
      sum += std::log2(light);
      count += 1.0;
    }
  }
  if (count == 0.0) return 1.0f;
  const double stops = std::round(std::log2(0.18) - sum / count);
  return static_cast<float>(std::exp2(std::fmin(std::fmax(stops, -20.0), 20.0)));
}

}  // namespace eigenlight
