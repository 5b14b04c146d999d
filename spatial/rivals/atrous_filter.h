// Edge-avoiding a-trous wavelets as published.
#pragma once

#include "spatial/rivals/spatial_filter.h"
#include "spatial/rivals/tap_planes.h"

namespace eigenlight {

struct AtrousFilterOptions {
  int passes = 4;  ///< [1, 6]; pass i reaches 2 * 2^i pixels
  /// (0, 1e6] difference of colors, over the frame's mean luminance, that weighs a neighbor by 1/e
  /// in the first pass.
  float sigma_color = 1024.0f;
  float sigma_normal = 0.2f;  ///< (0, 10] distance of two unit normals that does
  /// (0, 10] of the depth: distance of two points that does.
  float sigma_position = 0.06f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Dammertz, Sewtz, Hanika and Lensch 2010, as their listing has it. Pass i = 0, 1, ... with step
/// s = 2^i turns c_i into
///   c_(i+1)(p) = sum_q h(q) W(p, q) c_i(q) / sum_q h(q) W(p, q),  q = p + s (-2 .. 2, -2 .. 2),
///   W = w_q exp(-|c_i(p) - c_i(q)|^2 / (2^-i sigma_color m)^2
///               - |N_p - N_q|^2 / (s sigma_normal)^2
///               - |X_p - X_q|^2 / (sigma_position depth_p)^2)
/// with h the 5 x 5 B3-spline, N normals, X positions, m the mean luminance of the frame's usable
/// light (the paper's sigmas are absolute; taken relative they fit any exposure and scene). The
/// last c is the result: the paper drops the details. w is the weight of the inputs in the first
/// pass, and afterwards 1 where a value has been found; a pixel without any takes colors as equal.
///
/// What counts as a surface and as usable light: tap_planes.h. Output is 0 where no tap has a
/// weight, and stays within the range of the signal. `atrous.h` is another filter: it is steered by
/// each pixel's variance, which no single frame knows.
class AtrousFilter final : public SpatialFilter {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  AtrousFilter(Extent extent, const AtrousFilterOptions& options);

  void process(const SpatialInputs& in, Planes<3>& out) override;

 private:
  [[nodiscard]] float mean_luminance();

  AtrousFilterOptions options_;
  TileGrid grid_;
  TapPlanes planes_;
  TapLight next_;
  struct Sum {
    double luminance = 0.0, pixels = 0.0;
  };
  PerTile<Sum> sums_;
};

}  // namespace eigenlight
