// Where surfaces meet, history is a mixture of places.
#pragma once

#include "frame/frame.h"
#include "frame/tiles.h"
#include "reproject/taps.h"

namespace eigenlight {

struct EdgeInputs {
  const Frame& frame;           ///< surface, camera and motion
  const Plane<float>& samples;  ///< this frame's samples over its regular number
};

/// Ends memory sooner at edges whose history is blended: age <- min(age, max(longest, samples)) at
/// pixels p of `tile` that came from between pixels (both components of motion together are more
/// than 1e-3 off whole ones, which is more than a projection is rounded by) and have a neighbor q,
/// of the four in the image, that shows another surface in the sense of taps:
///   id_q != id_p,  N_p . N_q < normal_cosine  or  |N_p . (X_q - X_p)| > plane_distance * depth_p.
///
/// Light at such places (crevices, rims, the foot of a wall) changes within less than a pixel, and
/// a bilinear history brings along what is beside. Ages that stay low also draw further samples
/// there (spatial/sample_budget.h). Pixels without surface keep their age.
///
/// `tile` starts and ends at multiples of 16 pixels (vectors) or ends with the image.
void shorten_edge_ages(const EdgeInputs& in, const TapOptions& options, float longest,
                       const Tile& tile, Plane<float>& age);

}  // namespace eigenlight
