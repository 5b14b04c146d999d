// All lights of one frame: sampling them, and radiance that rays receive from them.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "render/lights/emitter_table.h"
#include "render/lights/environment_light.h"
#include "render/lights/light_shapes.h"
#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// A random direction towards a light.
struct LightSample {
  glm::vec3 direction{0.0f};  ///< unit vector from the receiver towards the light
  float distance = 0.0f;      ///< inf for suns and the environment
  glm::vec3 value{0.0f};      ///< radiance / pdf, without occlusion
  float pdf = 0.0f;           ///< per steradian; inf for suns
};

/// A rectangle or sphere light that a ray met. Light shapes emit and reflect nothing.
struct ShapeHit {
  float t = 0.0f;
  std::uint32_t shape = 0;  ///< index into Lights::rects, then Lights::spheres
  glm::vec3 radiance{0.0f};
};

/// Samples two groups of lights separately: suns, and local lights (light shapes, emissive
/// triangles and the environment). Either group can outshine the other at one point and be hidden
/// at the next. The constant sky is in neither group, because cosine-distributed rays sample it
/// perfectly.
class LightSet {
 public:
  /// `scene` and `geometry` must outlive this. Call update() before any other function.
  LightSet(const Scene& scene, const EmbreeScene& geometry);

  /// Sets the lights of one frame. Emissive triangles take the current poses of the geometry.
  void update(const Lights& lights);

  /// Samples a sun by its irradiance on a surface with `normal`. nullopt if no sun is above the
  /// horizon.
  [[nodiscard]] std::optional<LightSample> sample_sun(const glm::vec3& normal,
                                                      const glm::vec2& u) const;
  /// Samples a local light by an estimate of its irradiance at `from`, and a point on it. `pick` in
  /// [0, 1) selects the light, `u` in [0, 1)^2 the point.
  [[nodiscard]] std::optional<LightSample> sample_local(const glm::vec3& from, float pick,
                                                        const glm::vec2& u) const;
  [[nodiscard]] bool has_suns() const { return !lights_.suns.empty(); }
  [[nodiscard]] bool has_local() const;

  /// Whether cosine-distributed rays can meet light: true if there is any light but suns.
  [[nodiscard]] bool has_visible_lights() const;
  /// Whether some of that light comes from surfaces, so that an occlusion test is not enough.
  [[nodiscard]] bool has_visible_surfaces() const;
  /// Radiance of sky and environment along a guide ray that left the scene.
  [[nodiscard]] glm::vec3 background(const glm::vec3& direction) const;
  /// The same for a ray from `from` that was sampled with density `pdf`. The environment is
  /// multiplied by its weight against sample_local() (power heuristic; Veach 1997, eq. 9.13).
  [[nodiscard]] glm::vec3 background(const glm::vec3& from, const glm::vec3& direction,
                                     float pdf) const;

  [[nodiscard]] std::optional<ShapeHit> intersect(const Ray& ray) const;
  [[nodiscard]] bool occluded(const Ray& ray) const { return intersect(ray).has_value(); }
  /// Density per steradian with which sample_local() samples a ray that met a light shape.
  [[nodiscard]] float pdf(const Ray& ray, const ShapeHit& hit) const;

  /// Radiance that a triangle of Material::emission `emission` emits against the ray.
  [[nodiscard]] glm::vec3 emitted(const glm::vec3& emission, const glm::vec3& ray_direction) const;
  /// Density per steradian with which sample_local() samples a ray that met an emissive triangle.
  [[nodiscard]] float pdf(const Ray& ray, const Hit& hit) const;

  [[nodiscard]] const Lights& lights() const { return lights_; }

 private:
  struct SunDisk {
    float sine = 0.0f;              // sine of the half angle
    float one_minus_cosine = 0.0f;  // 1 - cosine of the half angle
  };
  [[nodiscard]] float sun_estimate(std::size_t sun, const glm::vec3& normal) const;
  [[nodiscard]] float environment_estimate() const;
  [[nodiscard]] float emitters_estimate(const glm::vec3& from) const;
  [[nodiscard]] float local_total(const glm::vec3& from) const;
  [[nodiscard]] std::optional<LightSample> sample_emitters(const glm::vec3& from, float pick,
                                                           const glm::vec2& u) const;
  [[nodiscard]] std::optional<LightSample> sample_environment(const glm::vec2& u) const;
  template <typename Shape>
  [[nodiscard]] std::optional<LightSample> sample_one(const Shape& shape, const glm::vec3& from,
                                                      const glm::vec2& u) const;

  const Scene* scene_;
  const EmbreeScene* geometry_;
  EnvironmentLight environment_;
  EmitterTable emitters_;
  bool has_emissive_materials_ = false;   // including those that emitters_ leaves out
  std::vector<glm::mat4> emitter_poses_;  // poses of the triangles in emitters_
  Lights lights_;
  std::vector<SunDisk> disks_;  // for each of lights_.suns
};

/// Weight of a sample of density `pdf` if another technique samples it with density `other`.
[[nodiscard]] inline float power_heuristic(float pdf, float other) {
  if (!(other > 0.0f)) return 1.0f;
  const float ratio = other / pdf;  // squares of densities could overflow
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace eigenlight
