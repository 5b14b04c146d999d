// Incremental PCA: the bases take this frame in.
#pragma once

#include "temporal/coefficients.h"

namespace eigenlight {

struct UpdateInputs {
  const CoefficientField& coefficients;
  const Planes<3>& prediction;
  const Planes<3>& light;        ///< u, resampling included; used where `samples` > 0
  const Plane<float>& samples;   ///< this frame's samples over its regular number; 0: none usable
  const Plane<float>& old_age;   ///< of the history; 0 where there is none
  const Plane<float>& new_age;   ///< with this frame
  std::span<const int> newborn;  ///< per tile: basis that starts from this frame's residual, or 0
};

/// One step of CCIPCA (Weng 2003; Chen 2012, Algorithm 1) with per-pixel weights w = samples / age
/// (Chen 2012, section 3.4.2; no amnesia: the innovation test shortens ages where light changed).
/// With r = u - prediction, the part of u that the bases do not explain:
///   V_0 <- c_0 V_0 + w r                       the steady light, scaled to the present one
///   V_k <- (1 - w) V_k + w c_k (c_k V_k + r)   k >= 1: Algorithm 1, line 8, where u_k, what the
///   other
///                                              bases leave over, is c_k V_k + r
/// The scale of V_k is sqrt(eigenvalue) instead of Algorithm 1's eigenvalue, so that c_k is of
/// order 1 and a new pixel can start at V_0 = u. A newborn basis starts as V_k = r (Algorithm 1,
/// line 6). Pixels without usable samples keep c_0 V_0; those without history start at u, or stay 0
/// without it.
///
/// Writes sum_k c_k V_k of the updated bases, this frame's temporal estimate, to `estimate`.
void update_tile(const UpdateInputs& in, const Tile& tile, BasisField& bases, Planes<3>& estimate);

}  // namespace eigenlight
