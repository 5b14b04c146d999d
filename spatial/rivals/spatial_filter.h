// The interface of filters that work on one frame alone.
#pragma once

#include "frame/frame.h"

namespace eigenlight {

struct SpatialInputs {
  const FrameInput& guides;    ///< normals, depth, albedo, position, id and camera are read
  const Planes<3>& signal;     ///< indirect radiance over albedo, linear; finite where weight > 0
  const Plane<float>& weight;  ///< >= 0; 0: the pixel's signal is not to be used
};

class SpatialFilter {
 public:
  virtual ~SpatialFilter() = default;

  /// Writes every pixel of `out`, which has the extent of the guides: the filtered signal on
  /// surfaces, those of weight 0 too as far as the filter can tell it from their surroundings, and
  /// 0 without surface. Keeps nothing from one call to the next. Throws std::invalid_argument if
  /// extents differ or `out` is the signal itself.
  virtual void process(const SpatialInputs& in, Planes<3>& out) = 0;
};

}  // namespace eigenlight
