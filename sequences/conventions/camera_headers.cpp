// Cameras from the matrices in file headers.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "sequences/conventions/camera_solve.h"

namespace eigenlight {
namespace {

// Files round their matrices to float, and some are printed to six digits.
constexpr double kTolerance = 2e-3;

using Matrix = std::array<float, 16>;

// Column c of a matrix for row vectors: the weights of x, y, z and 1.
struct Form {
  glm::dvec3 direction;
  double offset;
};

Form column(const Matrix& m, std::size_t c) { return {{m[c], m[4 + c], m[8 + c]}, m[12 + c]}; }

bool is_finite(const Matrix& m) {
  return std::all_of(m.begin(), m.end(), [](float v) { return std::isfinite(v); });
}

// Rows right, down and forward.
glm::mat3 view_rotation(const glm::dvec3& right, const glm::dvec3& down,
                        const glm::dvec3& forward) {
  return glm::mat3(glm::transpose(glm::dmat3(right, down, forward)));
}

// How NDC becomes pixels: pixel = scale * ndc + offset, with y down.
struct Window {
  glm::dvec2 scale, offset;
};

std::array<Window, 5> windows(Extent display, bool y_up) {
  const double w = display.width, h = display.height, s = std::min(w, h), sign = y_up ? -1 : 1;
  return {{
      {{w, sign * h}, {0, y_up ? h : 0}},                      // 0 to 1
      {{w / 2, sign * h / 2}, {w / 2, h / 2}},                 // -1 to 1
      {{w / 2, sign * w / 2}, {w / 2, h / 2}},                 // -1 to 1 over the width
      {{s / 2, sign * s / 2}, {w / 2, h / 2}},                 // -1 to 1 over the shorter side
      {{s, sign * s}, {w / 2 - s / 2, h / 2 - sign * s / 2}},  // 0 to 1 over the shorter side
  }};
}

// Focal length and center for the window that has square pixels; of several, the one whose center
// is nearest to that of the picture.
bool find_window(Extent display, bool y_up, const glm::dvec2& focal, const glm::dvec2& center,
                 Camera& camera) {
  const glm::dvec2 middle(0.5 * display.width, 0.5 * display.height);
  double nearest = 1.5 * std::max(display.width, display.height);
  bool found = false;
  for (const Window& window : windows(display, y_up)) {
    const double fx = focal.x * window.scale.x, fy = focal.y * std::abs(window.scale.y);
    if (std::abs(fx - fy) > kTolerance * fx) continue;
    const glm::dvec2 pixel = center * window.scale + window.offset;
    const double distance = glm::length(pixel - middle);
    if (distance > nearest - 0.5) continue;  // of equal ones the first
    nearest = distance;
    camera.focal = static_cast<float>(fx);
    camera.center = glm::vec2(pixel);
    found = true;
  }
  return found;
}

bool agrees(const Form& axis, const glm::dvec3& direction, const glm::dvec3& eye) {
  const double length = glm::length(axis.direction);
  if (!(length > 0.0)) return false;
  const double cosine = glm::dot(axis.direction, direction) / length;
  const double distance = (glm::dot(axis.direction, eye) + axis.offset) / length;
  return cosine > 1.0 - kTolerance && std::abs(distance) < kTolerance * (1.0 + glm::length(eye));
}

}  // namespace

std::optional<Camera> camera_from_matrices(const Matrix& world_to_camera,
                                           const Matrix& world_to_ndc, Extent display) {
  check_extent(display);
  if (!is_finite(world_to_camera) || !is_finite(world_to_ndc)) return std::nullopt;
  const Form u = column(world_to_ndc, 0), v = column(world_to_ndc, 1), w = column(world_to_ndc, 3);
  const double unit = glm::length(w.direction);
  if (!(unit > 0.0)) return std::nullopt;  // no perspective
  const glm::dvec3 forward = w.direction / unit;
  const glm::dvec2 center(glm::dot(u.direction, forward) / unit,
                          glm::dot(v.direction, forward) / unit);
  glm::dvec3 right = u.direction - center.x * w.direction;
  glm::dvec3 down = v.direction - center.y * w.direction;
  const glm::dvec2 focal(glm::length(right) / unit, glm::length(down) / unit);
  if (!(focal.x > 0.0) || !(focal.y > 0.0)) return std::nullopt;
  right /= focal.x * unit;
  down /= focal.y * unit;
  if (std::abs(glm::dot(right, down)) > kTolerance) return std::nullopt;
  const glm::dmat3 forms = glm::transpose(glm::dmat3(u.direction, v.direction, w.direction));
  const glm::dvec3 eye = -(glm::inverse(forms) * glm::dvec3(u.offset, v.offset, w.offset));

  const bool y_up = glm::dot(column(world_to_camera, 1).direction, down) > 0.0;
  if (y_up) down = -down;
  if (!agrees(column(world_to_camera, 0), right, eye) ||
      !agrees(column(world_to_camera, 1), -down, eye)) {
    return std::nullopt;
  }
  Camera camera;
  if (!find_window(display, y_up, focal, center, camera)) return std::nullopt;
  camera.eye = glm::vec3(eye);
  camera.world_to_view = view_rotation(right, down, forward);
  return camera;
}

std::optional<Camera> camera_from_vray(const Matrix& camera_transform, float fov, Extent display) {
  check_extent(display);
  if (!is_finite(camera_transform) || !std::isfinite(fov)) return std::nullopt;
  if (fov <= 0.0f || fov >= 180.0f) return std::nullopt;
  glm::dvec3 axes[3];
  for (std::size_t row = 0; row < 3; ++row) {
    const float* from = camera_transform.data() + 4 * row;
    axes[row] = {from[0], from[1], from[2]};
    const double length = glm::length(axes[row]);
    if (!(length > 0.0)) return std::nullopt;
    axes[row] /= length;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(glm::dot(axes[i], axes[(i + 1) % 3])) > kTolerance) return std::nullopt;
  }
  Camera camera;
  camera.eye = {camera_transform[12], camera_transform[13], camera_transform[14]};
  camera.world_to_view = view_rotation(axes[0], axes[2], -axes[1]);
  const double half = glm::radians(static_cast<double>(fov)) / 2.0;
  camera.focal = static_cast<float>(0.5 * display.width / std::tan(half));
  camera.center =
      glm::vec2(static_cast<float>(display.width), static_cast<float>(display.height)) * 0.5f;
  return camera;
}

}  // namespace eigenlight
