// Planes of floats as the values of an OpenEXR channel.
#pragma once

#include "frame/plane.h"
#include "sequences/exr/exr_file.h"

namespace eigenlight {

/// Writes `rows` rows of a plane from row `first` on one behind the other, as floats or as halves.
/// Finite values that half would round to Inf become +-65504 and are counted, as are NaN and Inf,
/// which are kept.
ExrOverflow pack_rows(const Plane<float>& plane, int first, int rows, bool as_half, char* to);

/// A smaller picture: each pixel is the mean of the area that it covers.
[[nodiscard]] Plane<float> average_to(const Plane<float>& plane, Extent extent);

}  // namespace eigenlight
