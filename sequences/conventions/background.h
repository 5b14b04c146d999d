// Which depths mean that a pixel shows no surface.
#pragma once

#include <cmath>

namespace eigenlight {

/// Half's largest value: what 1e10, FLT_MAX or Inf become where a writer clamps them to half.
inline constexpr float kLargestHalf = 65504.0f;

/// From here on no depth is that of a surface. Cycles writes 1e10 into Depth and FLT_MAX into
/// Denoising Depth, V-Ray 1e18 and 1e30 as far range and far clip, RenderMan 1e38. A tenth of the
/// least of those, since the values may have been rounded. In centimeters it is the radius of the
/// Earth.
inline constexpr float kFarthestDepth = 1e9f;

/// True for NaN, Inf, 0 and less (Arnold, Mitsuba and pbrt leave 0 where nothing was hit), 65504
/// and all from 1e9 on. Depths between 65504 and 1e9 are those of surfaces: scenes in millimeters
/// and centimeters have them.
[[nodiscard]] inline bool is_background(float depth) {
  return !std::isfinite(depth) || depth <= 0.0f || depth == kLargestHalf || depth >= kFarthestDepth;
}

}  // namespace eigenlight
