// Two walls that meet in an edge, seen at an angle.
#pragma once

#include <glm/glm.hpp>
#include <limits>

#include "frame/frame.h"

namespace eigenlight {

/// The camera at the origin looks along z. Pixels left of `edge` show a wall that leans to the left
/// and up, those from there on one that leans to the right, through the same point of the axis.
[[nodiscard]] inline Frame make_walls(Extent extent, int edge) {
  Frame frame;
  frame.resize(extent);
  frame.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 30.0f, extent);
  const glm::mat3 to_world = glm::transpose(frame.camera.world_to_view);
  const glm::vec3 left = glm::normalize(glm::vec3(0.5f, 0.2f, -1.0f));
  const glm::vec3 right = glm::normalize(glm::vec3(-0.6f, 0.0f, -1.0f));
  const glm::vec3 point(0.0f, 0.0f, 4.0f);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::vec3 normal = x < edge ? left : right;
      const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const glm::vec3 ray = to_world * frame.camera.pixel_to_view(center);
      frame.surface.depth(x, y) = glm::dot(normal, point) / glm::dot(normal, ray);
      frame.surface.id(x, y) = 1;
      for (int c = 0; c < 3; ++c) {
        frame.surface.normal[static_cast<std::size_t>(c)](x, y) = normal[c];
      }
    }
  }
  return frame;
}

/// Takes the surface away from a pixel.
inline void open_to_sky(Frame& frame, int x, int y) {
  frame.surface.id(x, y) = 0;
  frame.surface.depth(x, y) = std::numeric_limits<float>::infinity();
  for (auto& plane : frame.surface.normal) plane(x, y) = 0.0f;
}

}  // namespace eigenlight
