// Guides of a pixel in double, for twins of the spatial filters.
#pragma once

#include <glm/glm.hpp>

#include "spatial/rivals/spatial_filter.h"

namespace eigenlight::reference {

struct SurfacePoint {
  glm::dvec3 normal, position, albedo;
  double depth = 0.0;
};

inline glm::dvec3 vector_at(const Planes<3>& planes, glm::ivec2 p) {
  return {planes[0](p.x, p.y), planes[1](p.x, p.y), planes[2](p.x, p.y)};
}

/// The position is relative to the eye.
inline SurfacePoint surface_point(const FrameInput& frame, glm::ivec2 p) {
  const Camera& camera = frame.camera;
  const double depth = static_cast<double>(frame.surface.depth(p.x, p.y));
  const glm::dvec2 image =
      (glm::dvec2(p) + 0.5 - glm::dvec2(camera.center)) / static_cast<double>(camera.focal);
  const glm::dvec3 view = glm::dvec3(image, 1.0) * depth;
  return {vector_at(frame.surface.normal, p),
          glm::transpose(glm::dmat3(camera.world_to_view)) * view,
          vector_at(frame.surface.albedo, p), depth};
}

inline double squared(const glm::dvec3& v) { return glm::dot(v, v); }

}  // namespace eigenlight::reference
