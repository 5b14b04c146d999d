// The innovation test: does the local mean of the residual exceed its noise?
#pragma once

#include "frame/frame.h"
#include "frame/tiles.h"
#include "temporal/bases/tile_sums.h"

namespace eigenlight {

struct InnovationOptions {
  /// [0, 100] squared standard errors that a local mean may be off by chance. 2 had less error than
  /// 4 under changing light, and longer ages than 1 under steady light.
  float threshold = 2.0f;
  /// [1, 255] frames: ages saturate here.
  float max_age = kLongestAge;
  bool test = true;  ///< false: b = 0, ages grow whatever the residual is

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct InnovationInputs {
  const Plane<float>& innovation;  ///< luminance of u - prediction; NaN: not confirmed
  const Plane<float>& age;         ///< of the history
  const Plane<float>& samples;     ///< this frame's samples over its regular number; 0: not usable
};

struct InnovationOutputs {
  Plane<float>& age;       ///< frames' worth of samples after this frame; may be the input
  Plane<float>& variance;  ///< in: one frame's variance so far (warped); out: with this frame
};

/// Over the window of 9 x 9 pixels, with N confirmed innovations e, mean mu and variance v:
///   t = mu^2 / (v / N * (1 + 1/n)),   b^2 = mu^2 max(0, 1 - threshold / t)
/// is the squared bias that noise does not explain. The history of n frames has the error v/n +
/// b^2, this frame's mean over s times the regular samples v/s; the Kalman gain that balances them
/// is
///   w = (v/n + b^2) / (v/n + b^2 + v/s),   and the new age s/w, at most max(max_age, s).
/// Without bias, or with N = 1, that is n + s. So it is at unconfirmed pixels: new ones start at
/// age s, those without usable sample (s = 0) keep theirs. The variance of one frame is a running
/// mean of v over min(new age / s, 16) frames: where history is dropped, so is its variance.
///
/// `tile` starts and ends at multiples of 16 pixels (vectors) or ends with the image.
void innovation_tile(const InnovationInputs& in, const InnovationOptions& options, const Rect& tile,
                     const InnovationOutputs& out);

}  // namespace eigenlight
