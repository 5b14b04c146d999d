// Incremental PCA: updates the bases by this frame.
#pragma once

#include "temporal/bases/coefficients.h"

namespace eigenlight {

struct UpdateInputs {
  const CoefficientField& coefficients;
  const CoefficientField& learning_rates;  ///< q of CoefficientHistory
  const Planes<3>& residual;               ///< u - prediction; used where `samples` > 0
  const Planes<3>* correction;             ///< of the prediction; null: none anywhere in the tile
  const Plane<float>& samples;  ///< this frame's samples over its regular number; 0: none usable
  const Plane<float>& old_age;  ///< of the history; 0 where there is none
  const Plane<float>& new_age;  ///< with this frame
  int active;                   ///< bases in use, [1, K]
  int newborn;                  ///< basis that starts from the correction, or 0
};

struct UpdateOutputs {
  BasisField& bases;    ///< in and out; room for `active` and the newborn, other slots get 0
  Planes<3>& estimate;  ///< sum_k c_k V_k of the updated bases: this frame's temporal estimate
};

/// One step of incremental PCA with per-pixel weights (Chen 2012, Algorithm 1 and section 3.4.2),
/// in the form of CoefficientHistory. With c = (1, c_1, ...) after the rescaling by the gain c_0, r
/// = residual - correction, s samples, n = new age - s, q = M^-1 c and h = c . q:
///   V_0 <- c_0 V_0                                     the steady light, scaled to the present one
///   V_k <- V_k + q_k (correction / h + r s / (n + h s))
/// so that sum_k c_k V_k moves by the whole correction and by h s / (n + h s) of r. With one basis
/// this is the running mean. A newborn basis is set to the correction, with c_k = 1. A new pixel
/// has n = 0 and starts at the V of least energy that reproduces u. Pixels without usable samples
/// keep their history, or stay 0 without history.
void update_tile(const UpdateInputs& in, const Rect& tile, const UpdateOutputs& out);

}  // namespace eigenlight
