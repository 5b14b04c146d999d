// The pyramid filter for indirect light, guided by normals and depth.
#pragma once

#include <vector>

#include "spatial/rivals/pyramid_kernel.h"
#include "spatial/rivals/spatial_filter.h"

namespace eigenlight {

/// What Pyramid<GlobalIlluminationEdge> does (pyramid.h), in vectors, from the guides of a frame. A
/// surface counts that has an id, a depth in (0, inf) and a normal that is finite; pixels of other
/// kinds get 0. Allocates at construction only.
class PyramidFilter final : public SpatialFilter {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  PyramidFilter(Extent extent, const GlobalIlluminationEdge& edge,
                const PyramidTable& table = trained_pyramid_table());

  void process(const SpatialInputs& in, Planes<3>& out) override;

 private:
  Extent extent_;
  GlobalIlluminationEdge edge_;
  PyramidWeights weights_;             // of each pass
  std::vector<PyramidPlanes> levels_;  // 1 ..
};

}  // namespace eigenlight
