// Which pixels of a frame show surfaces that can be followed.
#pragma once

#include "frame/guides.h"
#include "frame/tiles.h"

namespace eigenlight {

struct GuideCounts {
  int surface = 0;  ///< pixels with an id
  int usable = 0;   ///< those of them for which has_usable_guides() is true
};

/// Counts the pixels [x0, x1) of row y0 of `row`.
[[nodiscard]] GuideCounts count_guides(const GBuffer& surface, const Rect& row);

}  // namespace eigenlight
