// The light that history predicts for this frame, and the residual.
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
///   prediction = sum_k c_k V_k,   residual = u - prediction,
/// for the pixels of a coefficient tile.
///
/// The variance follows a gain c_0 that jumps: variance <- g^2 variance, with g = c_0 / 2 above 2,
/// g = 2 c_0 below 1/2, and 1 between. The running mean of variances follows smaller changes: if
/// one of several lights changes, the change of the noise is unknown. (Scaling by c_0^2 always gave
/// a relMSE of 0.055 instead of 0.046 in `atrium --perturb lights` at 320x180.)
void predict_tile(const BasisField& bases, const CoefficientField& coefficients, const Rect& tile,
                  const PredictOutputs& out);

}  // namespace eigenlight
