// Rectangle and sphere lights: meeting them and choosing points on them.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// Distance to the side that shines, within the ray's bounds; nothing from behind or from within:
/// the dark side lets rays pass.
[[nodiscard]] std::optional<float> intersect(const AreaRect& rect, const Ray& ray);
[[nodiscard]] std::optional<float> intersect(const SphereLight& sphere, const Ray& ray);

/// Unit normal of the side that shines, at a point on the shape.
[[nodiscard]] glm::vec3 shape_normal(const AreaRect& rect, const glm::vec3& point);
[[nodiscard]] glm::vec3 shape_normal(const SphereLight& sphere, const glm::vec3& point);

/// A point on a light as seen from elsewhere.
struct ShapeSample {
  glm::vec3 direction{0.0f};  ///< unit, towards the light
  float distance = 0.0f;
  float pdf = 0.0f;  ///< per steradian; 0: the light cannot be seen from there
};

/// Uniform over the area of a rectangle; uniform over the cone that a sphere fills.
[[nodiscard]] ShapeSample sample_shape(const AreaRect& rect, const glm::vec3& from,
                                       const glm::vec2& u);
[[nodiscard]] ShapeSample sample_shape(const SphereLight& sphere, const glm::vec3& from,
                                       const glm::vec2& u);

/// Density with which sample_shape() yields the direction of a ray from `from` that meets the light
/// at `distance`.
[[nodiscard]] float shape_pdf(const AreaRect& rect, const glm::vec3& direction, float distance);
[[nodiscard]] float shape_pdf(const SphereLight& sphere, const glm::vec3& from);

/// Rough irradiance that the light gives a surface at `from` that faces it; 0 only where the light
/// cannot be seen. For choosing among lights.
[[nodiscard]] float estimate_irradiance(const AreaRect& rect, const glm::vec3& from);
[[nodiscard]] float estimate_irradiance(const SphereLight& sphere, const glm::vec3& from);

/// Orthonormal right-handed frame around a unit vector (Duff et al., JCGT 6(1), 2017), times a
/// vector given in that frame (z along `axis`).
[[nodiscard]] glm::vec3 around(const glm::vec3& axis, const glm::vec3& local);

/// Uniform direction within a cone whose half angle has 1 - cosine = `rise`, around `axis`.
[[nodiscard]] glm::vec3 sample_cone(const glm::vec3& axis, float rise, const glm::vec2& u);

}  // namespace eigenlight
