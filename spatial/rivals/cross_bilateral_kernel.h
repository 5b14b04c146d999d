// The cross bilateral filter of one tile; see cross_bilateral.h.
#pragma once

#include "spatial/rivals/cross_bilateral.h"

namespace eigenlight {

void cross_bilateral_tile(const TapPlanes& planes, const CrossBilateralOptions& options,
                          const Rect& tile, Planes<3>& out);

}  // namespace eigenlight
