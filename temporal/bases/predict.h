// What the history says this frame should look like.
#pragma once

#include "frame/frame.h"
#include "temporal/bases/coefficients.h"

namespace eigenlight {

struct PredictOutputs {
  /// In: u, this frame's indirect light, resampling included; out: u - prediction, in its place.
  Planes<3>& residual;
  Plane<float>& innovation;  ///< luminance of the residual; NaN without history or where u is NaN
  Plane<float>& expected;    ///< luminance of the prediction; 0 without history
  Plane<float>& variance;    ///< of one frame's luminance: in, of the history; out, of this light
};

/// Reconstruction (Chen 2012, Eq. 1) with interpolated coefficients,
///   prediction = sum_k c_k V_k,
/// and what it lacks of this frame's light, for the pixels of a coefficient tile.
///
/// Noise follows a light that jumps: variance <- g^2 variance, g what c_0 is beyond the range [1/2,
/// 2], over the end that it passes. Within it the running mean of variances follows by itself: a
/// light that is one of several changes the noise in no known way (scaled by c_0^2 always, relMSE
/// of `atrium --perturb lights` at 320x180 was 0.055 instead of 0.046).
void predict_tile(const BasisField& bases, const CoefficientField& coefficients, const Rect& tile,
                  const PredictOutputs& out);

}  // namespace eigenlight
