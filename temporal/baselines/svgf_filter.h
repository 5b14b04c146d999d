// The spatial part of SVGF: the variance of young pixels, and the a-trous passes.
#pragma once

#include "frame/frame.h"
#include "frame/tiles.h"

namespace eigenlight {

/// Edge-stopping functions of Schied et al. 2017, section 4.4.
struct SvgfWeights {
  float depth_slopes = 1.0f;      ///< sigma_z, (0, 100]
  int normal_squarings = 7;       ///< [0, 10]; sigma_n is 2 to this power: 128
  float luminance_sigmas = 4.0f;  ///< sigma_l, (0, 100]

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Light that is filtered; all planes have the extent of the guides.
struct SvgfImage {
  Planes<3> color;
  Plane<float> variance;  ///< of luminance

  explicit SvgfImage(Extent extent) : color(make_planes<3>(extent)), variance(extent) {}
};

struct SvgfPass {
  const FrameInput& guides;
  const SvgfWeights& weights;
  int step;                   ///< pixels between taps, >= 1
  const Plane<float>& known;  ///< 1 where the image has a value, else 0
};

/// One a-trous pass over one tile of at most 64 columns (Schied 2017, section 4.3 and Eq. 2 - 5):
///   out(p) = sum h(q) w(p, q) c(q) / sum h(q) w(p, q),
///   variance(p) = sum (h w)^2 variance(q) / (sum h w)^2,   h the 5 x 5 B3-spline with holes,
///   w = exp(-|z_p - z_q| / (sigma_z |grad z . (p - q)| + e_z)) max(0, N_p . N_q)^sigma_n
///       * exp(-|l_p - l_q| / (sigma_l sqrt(g(variance_p)) + e_l)),  g the 3 x 3 binomial.
/// grad z is that of the pixel's own plane. The paper does not give e_z and e_l. e_z = 1e-3 z_p
/// keeps rounding of depth from splitting planes that face the camera; e_l = 1e-4 l_p covers
/// rounding. Pixels that are not known are left out and become 0. `in` and `out` must not be the
/// same.
void svgf_pass_tile(const SvgfPass& pass, const SvgfImage& in, const Rect& tile, SvgfImage& out);

/// w of the geometry alone, between pixels p and q that show surfaces.
[[nodiscard]] float svgf_geometry_weight(const FrameInput& guides, const SvgfWeights& weights,
                                         glm::ivec2 p, glm::ivec2 q);

}  // namespace eigenlight
