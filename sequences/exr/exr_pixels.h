// Planes of floats as the values of an OpenEXR channel.
#pragma once

#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

struct ExrOverflow {
  std::int64_t clamped = 0;     ///< finite, but too large for half
  std::int64_t not_finite = 0;  ///< NaN and Inf
};

enum class ExrPack {
  kFloat,
  kHalf,         ///< beyond 65504: Inf
  kClampedHalf,  ///< finite values that half would round to Inf become +-65504
};

/// Writes `rows` rows of a plane from row `first` on one behind the other. Counts clamped values
/// and those that are not finite.
ExrOverflow pack_rows(const Plane<float>& plane, int first, int rows, ExrPack as, char* to);

/// A smaller picture: each pixel is the mean of the area that it covers.
[[nodiscard]] Plane<float> average_to(const Plane<float>& plane, Extent extent);

}  // namespace eigenlight
