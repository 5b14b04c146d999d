// Cross bilateral filter: the brute force that faster filters approximate.
#pragma once

#include "spatial/rivals/spatial_filter.h"
#include "spatial/rivals/tap_planes.h"

namespace eigenlight {

struct CrossBilateralOptions {
  int radius = 16;  ///< [1, 32] pixels; a window has 2 radius + 1 on a side
  /// (0, 10] distance of two unit normals that weighs a neighbor by exp(-1/2).
  float sigma_normal = 0.4f;
  /// (0, 10] of the depth: distance off the pixel's tangent plane that does.
  float sigma_plane = 0.02f;
  /// (0, 10] distance of two albedos that does.
  float sigma_albedo = 0.5f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Joint or cross bilateral filter (Petschnigg et al. 2004; Eisemann and Durand 2004), guided by
/// normals, depth and albedo as Bauszat 2011, section 4, compares with:
///   out(p) = sum_q W(p, q) c(q) / sum_q W(p, q),  |p - q| <= radius in x and y,
///   W = w_q exp(-1/2 (|p - q|^2 / (radius / 2)^2 + |N_p - N_q|^2 / sigma_normal^2
///                     + (N_p . (X_q - X_p) / (sigma_plane depth_p))^2
///                     + |a_p - a_q|^2 / sigma_albedo^2))
/// with w the weight of the inputs, N normals, X positions, a albedos. Depth enters as the distance
/// off the tangent plane, so that a slanted wall is no edge.
///
/// What counts as a surface and as usable light: tap_planes.h. Output is 0 where no tap has a
/// weight. It stays within the range of the signal. Cost: (2 radius + 1)^2 taps a pixel.
class CrossBilateral final : public SpatialFilter {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  CrossBilateral(Extent extent, const CrossBilateralOptions& options);

  void process(const SpatialInputs& in, Planes<3>& out) override;

 private:
  CrossBilateralOptions options_;
  TileGrid grid_;
  TapPlanes planes_;
};

}  // namespace eigenlight
