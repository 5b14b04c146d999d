// Surfaces that cannot be followed, because a file or a renderer says nonsense of them.
#pragma once

#include <limits>

#include "frame/usable_surface.h"

namespace eigenlight {

/// Whether pixel (x, y) shows a usable surface whose normal has unit length, squared within 10 %,
/// which is more than half floats round.
[[nodiscard]] inline bool has_usable_guides(const GBuffer& surface, int x, int y) {
  if (!is_usable_surface(surface, x, y)) return false;
  float square = 0.0f;
  for (const auto& plane : surface.normal) square += plane(x, y) * plane(x, y);
  return square > 0.9f && square < 1.1f;
}

/// Gives pixel (x, y) the geometry of no surface, normal 0 and depth +inf, but leaves it its id: no
/// history is found for it and no filter mixes it with others, whatever was there. Its light stays
/// its own.
inline void drop_guides(FrameInput& frame, int x, int y) {
  for (auto& plane : frame.surface.normal) plane(x, y) = 0.0f;
  frame.surface.depth(x, y) = std::numeric_limits<float>::infinity();
}

}  // namespace eigenlight
