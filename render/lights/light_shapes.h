// Rectangle and sphere lights: intersection and sampling.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// Distance to the emitting side within the bounds of the ray. nullopt for rays from behind a
/// rectangle or from inside a sphere: the dark side lets rays pass.
[[nodiscard]] std::optional<float> intersect(const AreaRect& rect, const Ray& ray);
[[nodiscard]] std::optional<float> intersect(const SphereLight& sphere, const Ray& ray);

/// Unit normal of the emitting side at a point on the shape.
[[nodiscard]] glm::vec3 shape_normal(const AreaRect& rect, const glm::vec3& point);
[[nodiscard]] glm::vec3 shape_normal(const SphereLight& sphere, const glm::vec3& point);

/// A sampled point on a light shape, seen from another point.
struct ShapeSample {
  glm::vec3 direction{0.0f};  ///< unit vector towards the light
  float distance = 0.0f;
  float pdf = 0.0f;  ///< per steradian; 0 if the light does not shine there
};

/// Samples a rectangle uniformly by area, and a sphere uniformly by the solid angle it covers.
[[nodiscard]] ShapeSample sample_shape(const AreaRect& rect, const glm::vec3& from,
                                       const glm::vec2& u);
[[nodiscard]] ShapeSample sample_shape(const SphereLight& sphere, const glm::vec3& from,
                                       const glm::vec2& u);

/// Density per steradian with which sample_shape() samples the direction of a ray that meets the
/// light at `distance`.
[[nodiscard]] float shape_pdf(const AreaRect& rect, const glm::vec3& direction, float distance);
[[nodiscard]] float shape_pdf(const SphereLight& sphere, const glm::vec3& from);

/// Rough irradiance on a surface at `from` that faces the light; 0 only where the light does not
/// shine. Used to choose among lights.
[[nodiscard]] float estimate_irradiance(const AreaRect& rect, const glm::vec3& from);
[[nodiscard]] float estimate_irradiance(const SphereLight& sphere, const glm::vec3& from);

/// Takes `local` from an orthonormal right-handed frame with z along the unit vector `axis` to
/// world space (Duff et al., JCGT 6(1), 2017).
[[nodiscard]] glm::vec3 from_local_frame(const glm::vec3& axis, const glm::vec3& local);

/// Uniformly sampled direction in a cone around `axis`; `one_minus_cosine` is 1 - cosine of its
/// half angle.
[[nodiscard]] glm::vec3 sample_cone(const glm::vec3& axis, float one_minus_cosine,
                                    const glm::vec2& u);

}  // namespace eigenlight
