// Where a pixel was in the previous frame, and which of its four bilinear taps saw the same
// surface.
#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/tiles.h"

namespace eigenlight {

struct TapOptions {
  /// (0, 1] of the depth: a tap whose surface lies farther off the pixel's plane is another
  /// surface.
  float plane_distance = 0.02f;
  /// [-1, 1): a tap whose normal makes a smaller cosine with the pixel's is another surface.
  float normal_cosine = 0.9f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Pixels handled at once: the width of a stage tile.
inline constexpr int kSegment = 64;

/// The taps of up to kSegment pixels of one row: tap t of pixel i is pixel (x[i] + t % 2, y[i] + t
/// / 2) of the previous frame. Weights of valid taps sum to 1; all four are 0 where no tap is valid
/// (a new pixel) or the pixel shows no surface, and so is that of a tap outside the image.
struct TapSegment {
  alignas(64) float weight[4][kSegment];
  alignas(64) std::int32_t x[kSegment], y[kSegment];

  [[nodiscard]] glm::ivec2 tap(int t, int i) const { return {x[i] + t % 2, y[i] + t / 2}; }
};

/// The previous frame's surface, as far as taps need it.
struct PreviousSurface {
  const Camera& camera;
  const GBuffer& surface;
};

/// Reverse reprojection (Nehab et al. 2007, as Chen 2012, section 3.4, uses it).
///
/// Pixel p was at q = p + motion(p). Of the four pixels around q those are valid that lie in the
/// image, carry the same object id, and satisfy, with N the normal at p and X the point's position
/// one frame ago (pixel q at previous_depth, seen by the previous camera),
///   N . N_tap >= normal_cosine   and   |N . (X_tap - X)| <= plane_distance * depth.
/// For an object that turned between the frames N is off by the turn; at film rates that stays
/// within the plane bound. Motion or depth that is not finite leaves no valid tap.
///
/// Fills taps for pixels [x0, x1) of row y, and weights of 0 behind them up to a whole vector; x0 a
/// multiple of 16 (vectors), x1 - x0 <= kSegment.
void compute_taps(const FrameInput& current, const PreviousSurface& previous,
                  const TapOptions& options, const Rect& row, TapSegment& taps);

}  // namespace eigenlight
