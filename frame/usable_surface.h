// Which surfaces filters can calculate with, whatever a file holds.
#pragma once

#include <cmath>

#include "frame/frame.h"

namespace eigenlight {

/// Components of unit normals, with room for those that half floats have rounded.
inline constexpr float kLargestNormal = 1.01f;
/// Products of two of them, with as much room: powers of 64 stay below 4.
inline constexpr float kLargestCosine = 1.02f;
/// Depths and their inverses can be squared, and multiplied by the 1e4 that edge stops divide by.
inline constexpr float kNearestDepth = 1e-15f, kFarthestDepth = 1e15f;

/// Whether a pixel shows a surface (id not 0) whose normal and depth can be squared, summed and
/// divided by without overflow: depth in [kNearestDepth, kFarthestDepth], components of the normal
/// up to kLargestNormal. False for NaN and Inf, without a floating-point trap.
[[nodiscard]] inline bool is_usable_surface(const GBuffer& surface, int x, int y) {
  const float depth = surface.depth(x, y);
  bool usable = surface.id(x, y) != 0 && std::isgreaterequal(depth, kNearestDepth) &&
                std::islessequal(depth, kFarthestDepth);
  for (const auto& plane : surface.normal) {
    usable = usable && std::islessequal(std::abs(plane(x, y)), kLargestNormal);
  }
  return usable;
}

}  // namespace eigenlight
