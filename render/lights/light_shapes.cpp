#include "render/lights/light_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/lights/distribution.h"

namespace eigenlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float rect_area(const AreaRect& rect) {
  return 4.0f * glm::length(glm::cross(rect.half_u, rect.half_v));
}

// 1 - cosine of the half angle of the cone that the sphere covers; negative from inside. It is
// 1 - sqrt(1 - s), written as s / (1 + sqrt(1 - s)) to keep its digits for distant spheres.
float cone_one_minus_cosine(const SphereLight& sphere, const glm::vec3& from) {
  const glm::vec3 to_center = sphere.center - from;
  const float sine2 = sphere.radius * sphere.radius / glm::dot(to_center, to_center);
  return sine2 < 1.0f ? sine2 / (1.0f + std::sqrt(1.0f - sine2)) : -1.0f;
}

}  // namespace

glm::vec3 from_local_frame(const glm::vec3& axis, const glm::vec3& local) {
  const float sign = std::copysign(1.0f, axis.z);
  const float a = -1.0f / (sign + axis.z);
  const float b = axis.x * axis.y * a;
  const glm::vec3 x(1.0f + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
  const glm::vec3 y(b, sign + axis.y * axis.y * a, -axis.y);
  return local.x * x + local.y * y + local.z * axis;
}

glm::vec3 sample_cone(const glm::vec3& axis, float one_minus_cosine, const glm::vec2& u) {
  const float height = u.x * one_minus_cosine;  // 1 - cosine of the sample
  const float sine = std::sqrt(std::max(0.0f, height * (2.0f - height)));
  const float phi = 2.0f * kPi * u.y;
  return from_local_frame(axis, {sine * std::cos(phi), sine * std::sin(phi), 1.0f - height});
}

std::optional<float> intersect(const AreaRect& rect, const Ray& ray) {
  const glm::vec3 normal = glm::cross(rect.half_u, rect.half_v);
  const float facing = glm::dot(normal, ray.direction);
  if (!(facing < 0.0f)) return std::nullopt;
  const float t = glm::dot(normal, rect.center - ray.origin) / facing;
  if (!(t > ray.t_min && t < ray.t_max)) return std::nullopt;
  const glm::vec3 p = ray.origin + t * ray.direction - rect.center;
  // Coordinates along the two sides, which need not be perpendicular.
  const float area2 = glm::dot(normal, normal);
  const float a = glm::dot(glm::cross(p, rect.half_v), normal) / area2;
  const float b = glm::dot(glm::cross(rect.half_u, p), normal) / area2;
  if (std::abs(a) > 1.0f || std::abs(b) > 1.0f) return std::nullopt;
  return t;
}

std::optional<float> intersect(const SphereLight& sphere, const Ray& ray) {
  const glm::vec3 to_center = sphere.center - ray.origin;
  const float along = glm::dot(to_center, ray.direction);
  // Vector from the line to the center: stable for distant spheres (Haines et al., Ray Tracing
  // Gems, ch. 7).
  const glm::vec3 off = to_center - along * ray.direction;
  const float chord2 = sphere.radius * sphere.radius - glm::dot(off, off);
  if (!(chord2 > 0.0f)) return std::nullopt;
  const float t = along - std::sqrt(chord2);
  if (!(t > ray.t_min && t < ray.t_max)) return std::nullopt;
  return t;
}

glm::vec3 shape_normal(const AreaRect& rect, const glm::vec3& /*point*/) {
  return glm::normalize(glm::cross(rect.half_u, rect.half_v));
}

glm::vec3 shape_normal(const SphereLight& sphere, const glm::vec3& point) {
  return glm::normalize(point - sphere.center);
}

ShapeSample sample_shape(const AreaRect& rect, const glm::vec3& from, const glm::vec2& u) {
  const glm::vec3 point =
      rect.center + (2.0f * u.x - 1.0f) * rect.half_u + (2.0f * u.y - 1.0f) * rect.half_v;
  const float distance = glm::length(point - from);
  if (!(distance > 0.0f)) return {};
  const glm::vec3 direction = (point - from) / distance;
  return {direction, distance, shape_pdf(rect, direction, distance)};
}

ShapeSample sample_shape(const SphereLight& sphere, const glm::vec3& from, const glm::vec2& u) {
  const float one_minus_cosine = cone_one_minus_cosine(sphere, from);
  if (!(one_minus_cosine > 0.0f)) return {};
  const glm::vec3 direction =
      sample_cone(glm::normalize(sphere.center - from), one_minus_cosine, u);
  const std::optional<float> t = intersect(sphere, Ray{from, direction});
  // At the rim the ray may miss the sphere by rounding; the closest point of the ray is used then.
  const float distance = t ? *t : glm::dot(sphere.center - from, direction);
  return {direction, distance, 1.0f / (2.0f * kPi * one_minus_cosine)};
}

float shape_pdf(const AreaRect& rect, const glm::vec3& direction, float distance) {
  const glm::vec3 normal = glm::cross(rect.half_u, rect.half_v);
  // cosine * area = -4 dot(direction, cross(half_u, half_v))
  const float projected = -4.0f * glm::dot(direction, normal);
  return projected > 0.0f ? distance * distance / projected : 0.0f;
}

float shape_pdf(const SphereLight& sphere, const glm::vec3& from) {
  const float one_minus_cosine = cone_one_minus_cosine(sphere, from);
  return one_minus_cosine > 0.0f ? 1.0f / (2.0f * kPi * one_minus_cosine) : 0.0f;
}

float estimate_irradiance(const AreaRect& rect, const glm::vec3& from) {
  const glm::vec3 to_point = from - rect.center;
  const glm::vec3 normal = glm::cross(rect.half_u, rect.half_v);
  const float height = glm::dot(to_point, normal);  // height above the plane * area / 4
  if (!(height > 0.0f)) return 0.0f;
  const float distance2 = glm::dot(to_point, to_point);
  const float cosine = height / std::sqrt(distance2 * glm::dot(normal, normal));
  const float area = rect_area(rect);
  // A tenth of the estimate ignores the angle: near the plane of a large rectangle, some of its
  // parts are seen much less obliquely than its center.
  return luminance(rect.radiance) * area * (0.1f + 0.9f * cosine) / (distance2 + area);
}

float estimate_irradiance(const SphereLight& sphere, const glm::vec3& from) {
  const glm::vec3 to_center = sphere.center - from;
  const float distance2 = glm::dot(to_center, to_center);
  const float radius2 = sphere.radius * sphere.radius;
  return distance2 > radius2 ? kPi * luminance(sphere.radiance) * radius2 / distance2 : 0.0f;
}

}  // namespace eigenlight
