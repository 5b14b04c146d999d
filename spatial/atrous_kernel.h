// One pass of the a-trous filter over one tile; see atrous.h.
#pragma once

#include <span>

#include "spatial/atrous.h"

namespace eigenlight {

/// What a pass reads and writes of one image.
struct AtrousWork {
  const Planes<3>* color;
  const Plane<float>* variance;
  const Plane<float>* earlier;  ///< null: none; all images have one, or none has
  Planes<3>* out_color;
  Plane<float>* out_variance;
};

struct AtrousPass {
  const FrameInput& guides;
  const AtrousOptions& options;
  const PlanarBlocks& planar;
  int step;                          ///< pixels between taps
  std::span<const AtrousWork> work;  ///< 1 to Atrous::kMostImages, all with the frame's extent
};

void atrous_tile(const AtrousPass& pass, const Rect& tile);

}  // namespace eigenlight
