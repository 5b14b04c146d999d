// Counts the pixels of a frame whose surfaces can be reprojected.
#pragma once

#include "frame/guides.h"
#include "frame/tiles.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

/// Counts the pixels [x0, x1) of row y0 of `row`: surface pixels (id not 0), and the unguided ones
/// of them, for which has_usable_guides() is false.
[[nodiscard]] PixelCounts count_guides(const GBuffer& surface, const Rect& row);

}  // namespace eigenlight
