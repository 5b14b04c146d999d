// Surfaces that cannot be followed, because a file or a renderer says nonsense of them.
#pragma once

#include <limits>

#include "frame/frame.h"

namespace eigenlight {

/// Whether the surface of pixel (x, y) has a normal of unit length (squared within 10 %, more than
/// half floats round) and a depth in (1e-18, 1e18), beyond which float cannot square it. NaN is no.
[[nodiscard]] inline bool has_usable_guides(const GBuffer& surface, int x, int y) {
  float square = 0.0f;
  for (const auto& plane : surface.normal) square += plane(x, y) * plane(x, y);
  const float depth = surface.depth(x, y);
  return square > 0.9f && square < 1.1f && depth > 1e-18f && depth < 1e18f;
}

/// Gives pixel (x, y) the geometry of no surface, normal 0 and depth +inf, but leaves it its id: no
/// history is found for it and no filter mixes it with others, whatever was there. Its light stays
/// its own.
inline void drop_guides(Frame& frame, int x, int y) {
  for (auto& plane : frame.surface.normal) plane(x, y) = 0.0f;
  frame.surface.depth(x, y) = std::numeric_limits<float>::infinity();
}

}  // namespace eigenlight
