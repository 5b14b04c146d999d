// Edges of geometry, where a bilinear history mixes several surfaces.
#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "reproject/taps.h"

namespace eigenlight {

/// Marks edges whose history is blended: 1 at pixels p of `tile` that came from between pixels
/// (both components of motion together are more than 1e-3 off whole ones, which is more than a
/// projection is rounded by) and have a neighbor q, of the four in the image, that shows another
/// surface in the sense of taps:
///   id_q != id_p,  N_p . N_q < normal_cosine  or  |N_p . (X_q - X_p)| > plane_distance * depth_p.
/// 0 elsewhere, and where there is no surface.
///
/// Light at such places (crevices, rims, the foot of a wall) changes within less than a pixel, and
/// a bilinear history blends it with its surroundings, so ages are limited there. Low ages also
/// draw extra samples (spatial/sample_budget.h).
///
/// `tile` starts and ends at multiples of 16 pixels (vectors) or ends with the image.
void find_edges(const FrameInput& frame, const TapOptions& options, const Rect& tile,
                Plane<std::uint8_t>& edge);

/// Longest ages in frames.
struct LongestAges {
  float inside, at_edges;
};

/// age <- min(age, max(longest, samples)). An age below this frame's own samples (over their
/// regular number) would give them a weight above 1.
void shorten_ages(const Plane<std::uint8_t>& edge, const Plane<float>& samples,
                  const LongestAges& longest, const Rect& tile, Plane<float>& age);

}  // namespace eigenlight
