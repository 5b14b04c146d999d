#include "sequences/conventions/depth_slopes.h"

#include <cmath>

#include "sequences/conventions/background.h"

namespace eigenlight {
namespace {

// Pixels from a pixel to those that its slope is taken from: the rounding of half's depths then
// turns it by a degree or two, not by ten.
constexpr int kReach = 4;
// Inverse depth is linear on planes; more than that off, relative, is an edge.
constexpr float kBend = 0.01f;

glm::vec2 center_of(int x, int y) {
  return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
}

}  // namespace

bool DepthSlopes::normal_at(int x, int y, glm::vec3& normal) const {
  const Extent extent = depth_.extent();
  if (!extent.contains(x - kReach, y - kReach) || !extent.contains(x + kReach, y + kReach)) {
    return false;
  }
  glm::vec3 across, down;
  if (!difference(x, y, kReach, 0, across) || !difference(x, y, 0, kReach, down)) return false;
  const glm::vec3 crossed = glm::cross(across, down);
  const float length = glm::length(crossed);
  if (!(length > 0.0f)) return false;
  glm::vec3 view = crossed / length;
  if (glm::dot(view, camera_.pixel_to_view(center_of(x, y))) > 0.0f) view = -view;
  normal = glm::transpose(camera_.world_to_view) * view;
  return true;
}

float DepthSlopes::axis_depth(int x, int y) const {
  const float depth = depth_(x, y);
  if (is_background(depth)) return 0.0f;
  const glm::vec3 ray = camera_.pixel_to_view(center_of(x, y));
  return static_cast<float>(depth * reading_.scale) /
         (reading_.along_ray ? glm::length(ray) : 1.0f);
}

bool DepthSlopes::difference(int x, int y, int dx, int dy, glm::vec3& difference) const {
  const float before = axis_depth(x - dx, y - dy), here = axis_depth(x, y),
              after = axis_depth(x + dx, y + dy);
  if (before <= 0.0f || here <= 0.0f || after <= 0.0f) return false;
  if (std::abs(here / before + here / after - 2.0f) > kBend) return false;
  difference = camera_.pixel_to_view(center_of(x + dx, y + dy)) * (after / here) -
               camera_.pixel_to_view(center_of(x - dx, y - dy)) * (before / here);
  return true;
}

}  // namespace eigenlight
