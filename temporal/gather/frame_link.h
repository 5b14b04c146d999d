// Where the pixels of a frame are in the frame before and in the one after it.
#pragma once

#include "spatial/packed_guides.h"

namespace eigenlight {

/// The place of a pixel in the other frame minus its place here, in pixels, and the logarithm of
/// its depth there minus that here. `known` is 1, or 0 and all others are 0.
struct Link {
  float x, y, log_depth, known;
};
using FrameLink = Plane<Link>;

/// The least weight of guides (guide_weight()) at which two pixels may show the same point. It is
/// low, for means over a few samples at edges differ much from frame to frame.
inline constexpr float kLeastMatch = 0.05f;

/// From a frame to the one before it, by motion and previous_depth. The place is unknown where
/// these are not finite, or a depth is not positive.
void link_back(const FrameInput& frame, FrameLink& link);

/// Pixels of a surface that the frame before, with the guides `before`, does not show.
[[nodiscard]] std::int64_t count_new(const FrameLink& back, const Plane<PackedGuide>& guides,
                                     const Plane<PackedGuide>& before, const GuideWidths& widths);

/// From the frame before to a frame that knows only where its own pixels came from: `back` turned
/// around. A pixel takes the link of that pixel which came closest to its center and is like it by
/// guides. Where none came (it is hidden, or left the picture) its place is unknown; gaps of a
/// pixel, as a picture that grows leaves them, are filled from like neighbors.
class LinkAhead {
 public:
  /// `guides` of the frame that `back` starts from, `before` of the frame that it leads to.
  void find(const FrameLink& back, const Plane<PackedGuide>& guides,
            const Plane<PackedGuide>& before, const GuideWidths& widths, FrameLink& link);

 private:
  Plane<float> match_;
  FrameLink scattered_;
};

}  // namespace eigenlight
