// One pass of the published a-trous filter over one tile; see atrous_filter.h.
#pragma once

#include "spatial/rivals/atrous_filter.h"

namespace eigenlight {

struct AtrousFilterPass {
  const TapPlanes& planes;
  int step;               ///< pixels between taps
  float inverse_color;    ///< 1 / (2^-i sigma_color m)^2
  float inverse_normal;   ///< 1 / (s sigma_normal)^2
  float sigma_position;   ///< of the depth
  const TapLight& light;  ///< c_i
  TapLight& next;         ///< c_(i+1)
};

void atrous_filter_tile(const AtrousFilterPass& pass, const Rect& tile);

}  // namespace eigenlight
