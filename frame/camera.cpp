#include "frame/camera.h"

#include <cmath>
#include <numbers>

namespace eigenlight {

Camera look_at(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up, float fov_y,
               Extent extent) {
  check_extent(extent);
  EL_CHECK(fov_y > 0.0f && fov_y < 180.0f, "field of view {} degrees: expected (0, 180)", fov_y);
  const glm::vec3 view = target - eye;
  EL_CHECK(glm::length(view) > 0.0f, "camera eye and look_at are the same point");
  const glm::vec3 forward = glm::normalize(view);

  // Take the axis least parallel to the view where `up` gives no right.
  glm::vec3 right = glm::cross(forward, up);
  if (glm::length(right) < 1e-5f * glm::length(up) || glm::length(up) == 0.0f) {
    const glm::vec3 other = std::abs(forward.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
    right = glm::cross(forward, other);
  }
  right = glm::normalize(right);
  const glm::vec3 down = glm::cross(forward, right);

  Camera camera;
  camera.eye = eye;
  camera.world_to_view = glm::transpose(glm::mat3(right, down, forward));
  camera.focal = 0.5f * static_cast<float>(extent.height) /
                 std::tan(0.5f * fov_y * std::numbers::pi_v<float> / 180.0f);
  camera.center = 0.5f * glm::vec2(extent.width, extent.height);
  return camera;
}

}  // namespace eigenlight
