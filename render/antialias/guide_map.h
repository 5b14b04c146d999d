// Geometry and light of a frame's guide rays, for comparison with additional camera rays.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "frame/frame.h"
#include "render/paths/gbuffer.h"
#include "render/paths/sample_mean.h"

namespace eigenlight {

/// Geometry and light at the first hit of the ray through each pixel center. All planes have one
/// extent and must outlive this. Antialiasing only reads them.
struct GuideMap {
  const Frame& frame;
  const Plane<GuideHit>& hits;
  const Planes<3>& indirect;  ///< denoised, divided by albedo
  const Planes<3>& direct;    ///< the same: that of the frame, or denoised

  [[nodiscard]] bool is_surface(int x, int y) const {
    return frame.extent().contains(x, y) && hits(x, y).kind == GuideHit::Kind::kSurface;
  }
  [[nodiscard]] float depth(int x, int y) const { return frame.surface.depth(x, y); }
  [[nodiscard]] glm::vec3 normal(int x, int y) const {
    return load_pixel(frame.surface.normal, x, y);
  }
  [[nodiscard]] glm::vec3 indirect_light(int x, int y) const { return load_pixel(indirect, x, y); }
  [[nodiscard]] glm::vec3 light(int x, int y) const {
    return load_pixel(direct, x, y) + indirect_light(x, y);
  }
  /// Radiance along the guide ray: albedo * light + emission.
  [[nodiscard]] glm::vec3 color(int x, int y) const {
    return load_pixel(frame.surface.albedo, x, y) * light(x, y) + load_pixel(frame.emission, x, y);
  }
};

/// Hit of an additional camera ray on a surface.
struct EyePoint {
  glm::vec2 pixel{0.0f};  ///< pixel coordinates; pixel centers are at + 0.5
  float depth = 0.0f;     ///< along the view axis, > 0
  glm::vec3 normal{0.0f};
};

}  // namespace eigenlight
