// What the history says this frame should look like.
#pragma once

#include "frame/frame.h"
#include "temporal/coefficients.h"

namespace eigenlight {

struct PredictOutputs {
  Planes<3>& prediction;    ///< sum_k c_k V_k; 0 without history
  Plane<float>& residual;   ///< luminance of u - prediction; 0 where `confirmed` is 0
  Plane<float>& confirmed;  ///< 1 where there is history and u is finite, else 0
  Plane<float>& age;        ///< of the history; 0 where there is none
  Plane<float>& variance;   ///< of one frame's luminance: in, of the history; out, c_0^2 times that
};

/// Reconstruction (Chen 2012, Eq. 1) with interpolated coefficients, and its residual against
/// `light` (this frame's indirect light, resampling included), for the pixels of a coefficient
/// tile. Noise follows the gain of the light that makes it.
void predict_tile(const BasisField& bases, const CoefficientField& coefficients,
                  const Planes<3>& light, const Tile& tile, const PredictOutputs& out);

}  // namespace eigenlight
