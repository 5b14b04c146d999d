// Pinhole camera: world to pixels and back.
#pragma once

#include <glm/glm.hpp>

#include "frame/plane.h"

namespace eigenlight {

/// A pinhole camera with square pixels. Right-handed world; in view space x points right, y points
/// DOWN (as pixel rows do) and z along the view axis, so that depth is the view-space z and
/// positive in front of the camera. Pixel (i, j) has its center at (i + 0.5, j + 0.5).
struct Camera {
  glm::vec3 eye{0.0f};
  glm::mat3 world_to_view{1.0f};  ///< rotation; rows are right, down, forward
  float focal = 1.0f;             ///< pixels from eye to image plane, > 0
  glm::vec2 center{0.0f};         ///< pixel coordinates of the view axis

  /// Point of view space (z > 0) to pixel coordinates.
  [[nodiscard]] glm::vec2 view_to_pixel(const glm::vec3& view) const {
    return glm::vec2(view.x, view.y) * (focal / view.z) + center;
  }
  /// Direction of view space with z = 1 through pixel coordinates; times depth: the point.
  [[nodiscard]] glm::vec3 pixel_to_view(const glm::vec2& pixel) const {
    return {(pixel - center) / focal, 1.0f};
  }
  [[nodiscard]] glm::vec3 to_view(const glm::vec3& world) const {
    return world_to_view * (world - eye);
  }
  [[nodiscard]] glm::vec3 to_world(const glm::vec3& view) const {
    return glm::transpose(world_to_view) * view + eye;
  }
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Camera at `eye` looking at `target`. `fov_y` in degrees, (0, 180). Where the view is parallel to
/// `up` another axis is taken. Throws std::invalid_argument if eye and target coincide or the field
/// of view is out of range.
[[nodiscard]] Camera look_at(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up,
                             float fov_y, Extent extent);

}  // namespace eigenlight
