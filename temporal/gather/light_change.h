// How light changes from a frame to the next one, over cells of many pixels.
#pragma once

#include <array>

#include "temporal/gather/frame_link.h"

namespace eigenlight {

/// Pixels along the side of a cell. Cells of 8 and 32 pixels gave the same errors
/// (docs/experiments/2026-12-looking-ahead.md).
inline constexpr int kChangeCell = 16;

/// Light of a frame over that of the next one. For each cell
///   g = sum l(e_i) / sum l(e_(i+1)),
/// l the luminance, over the pixels whose place in the next frame is known, with both sums smoothed
/// over 5 x 5 cells by binomial weights; 1 where a sum is not positive; within [1/16, 16]. e are
/// estimates that hold the samples of both frames and of all before them: what noise both share
/// cancels.
class LightChange {
 public:
  /// `link` leads from the frame of `estimate` to that of `next`. Values that are not finite are
  /// left out.
  void find(const Planes<3>& estimate, const Planes<3>& next, const FrameLink& link);
  /// At a place of the first frame, in pixels: linear between the centers of cells, and constant
  /// beyond the outermost ones.
  [[nodiscard]] float at(float x, float y) const;

 private:
  Plane<float> here_, there_, gain_;
};

}  // namespace eigenlight
