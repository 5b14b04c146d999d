// Basis filtering at newly seen pixels (Chen 2012, Fig. 6c).
#pragma once

#include <cstdint>
#include <vector>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "reproject/basis_field.h"

namespace eigenlight {

/// Smooths all bases at newly seen pixels with a joint bilateral filter of 11 x 11 pixels, the
/// smaller of the two windows that Chen 2012 compares with:
///   v(p) = sum_q w(p, q) v(q) / sum_q w(p, q) over pixels q of positive age,
///   w = exp(-|p - q|^2 / (2 * 2.5^2)) max(0, N_p . N_q)^64
///       * exp(-|N_p . (X_q - X_p)| / (0.02 depth_p)).
/// The paper does not give the weights. Normals and planes weigh as in the a-trous filter
/// (spatial/atrous.h); the window ends at two standard deviations. A pixel without a neighbor on
/// its surface keeps its values.
class NewPixelFilter {
 public:
  explicit NewPixelFilter(Extent extent);

  /// Filters pixels with a surface where `smooth` is not 0. Ages are not changed.
  void process(const FrameInput& frame, const Plane<std::uint8_t>& smooth, BasisField& bases);

 private:
  TileGrid tiles_;
  std::vector<std::vector<float>> filtered_;  // per tile: values of its filtered pixels, row by row
};

}  // namespace eigenlight
