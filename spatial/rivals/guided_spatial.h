// The guided filter as a filter of single frames.
#pragma once

#include "spatial/guided_filter.h"
#include "spatial/rivals/spatial_filter.h"

namespace eigenlight {

/// What suits single frames: docs/experiments/2026-11-single-frame-filters.md.
[[nodiscard]] inline GuidedOptions guided_alone() { return {.epsilon_depth = 0.0005f}; }

/// Bauszat, Eisemann and Magnor 2011, section 3.3: every pixel of each frame through GuidedFilter
/// (which see), with the weights of the inputs.
class GuidedSpatial final : public SpatialFilter {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  GuidedSpatial(Extent extent, const GuidedOptions& options);

  void process(const SpatialInputs& in, Planes<3>& out) override;

 private:
  GuidedFilter filter_;
  Plane<std::uint8_t> wanted_;
};

}  // namespace eigenlight
