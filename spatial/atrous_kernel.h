// One pass of the a-trous filter over one tile; see atrous.h.
#pragma once

#include "spatial/atrous.h"

namespace eigenlight {

struct AtrousPass {
  const FrameInput& guides;
  const AtrousOptions& options;
  const PlanarBlocks& planar;
  int step;  ///< pixels between taps
  const Planes<3>& color;
  const Plane<float>& variance;
  const Plane<float>* earlier;  ///< null: none
  Planes<3>& out_color;
  Plane<float>& out_variance;
};

void atrous_tile(const AtrousPass& pass, const Rect& tile);

}  // namespace eigenlight
