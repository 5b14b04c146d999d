// The regression of BMFR: light as a sum of features, block by block.
#pragma once

#include <vector>

#include "frame/frame.h"

namespace eigenlight {

struct BmfrFitInputs {
  const FrameInput& guides;    ///< normals, depth, id and camera are read
  const Planes<3>& light;      ///< finite where `usable` > 0
  const Plane<float>& usable;  ///< 0: the pixel is left out of the fits
  int jitter = 0;              ///< >= 0, which of the 16 block offsets
  float noise = 0.01f;         ///< (0, 1] amplitude of the noise that is added to the features
};

/// Koskela et al. 2019, sections 3.2 - 3.4. Blocks of 32 x 32 pixels, shifted by one of 16 offsets,
/// mirrored where they leave the image. In each the light of the usable pixels is fitted, in the
/// sense of least squares and by Householder QR, with 10 features: 1, normal, position, and
/// position squared by component; position in world space. As in the authors' implementation
/// position and its square go from 0 to 1 over the block where they span more than 1, else from 0
/// up. During the fit uniform noise in [-noise, noise) is added to all features but the first, so
/// that the system is not singular. The output is evaluated without noise:
///   out(p) = max(0, sum_m a_m feature_m(p)) at every pixel with a surface.
/// Two additions of this project: A block with fewer than 40 usable pixels (4 for each feature)
/// takes their mean, and 0 without any; the authors' blocks are always full. Pixels that are left
/// out of the fit are clamped to the block's largest light in each channel, because a polynomial
/// may grow beyond its points. Unusable surfaces (usable_surface.h) are left out and keep their own
/// light. `out` is 0 without surface. Throws std::invalid_argument if extents differ.
void bmfr_fit(const BmfrFitInputs& in, Planes<3>& out);

}  // namespace eigenlight
