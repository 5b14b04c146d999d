// All lights of one frame: choosing among them, and what rays see of them.
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

/// A direction that light comes from, chosen at random.
struct LightSample {
  glm::vec3 direction{0.0f};  ///< unit, from the receiver towards the light
  float distance = 0.0f;      ///< inf for suns and the environment
  glm::vec3 value{0.0f};      ///< radiance over the density of the choice; before occlusion
  float pdf = 0.0f;           ///< density of the choice, per steradian
};

/// A rectangle or sphere light that a ray met. They are black: they emit and reflect nothing.
struct ShapeHit {
  float t = 0.0f;
  std::uint32_t shape = 0;  ///< rectangles first, then spheres, as in Lights
  glm::vec3 radiance{0.0f};
};

/// Suns are chosen apart from all other lights ("local": shapes, emissive triangles, environment),
/// because one outshines the other in one place and is hidden in the next. The constant sky is in
/// neither group: cosine-distributed rays find it as well as any choice could.
class LightSet {
 public:
  /// `scene` and `geometry` must outlive this. Call update() before anything else.
  LightSet(const Scene& scene, const EmbreeScene& geometry);

  /// Lights of one frame, with emissive triangles at the current poses of the geometry.
  void update(const Lights& lights);

  /// One sun, by its irradiance on `normal`. Nothing where none is up.
  [[nodiscard]] std::optional<LightSample> sample_sun(const glm::vec3& normal,
                                                      const glm::vec2& u) const;
  /// One local light, by a rough estimate of its irradiance at `from`, and a point on it.
  [[nodiscard]] std::optional<LightSample> sample_local(const glm::vec3& from, float pick,
                                                        const glm::vec2& u) const;
  [[nodiscard]] bool has_suns() const { return !lights_.suns.empty(); }
  [[nodiscard]] bool has_local() const;

  /// Whether rays that are not aimed at lights can meet light: all but suns.
  [[nodiscard]] bool is_visible() const;
  /// Whether some of that light comes from surfaces: a ray must know what it met, not only whether.
  [[nodiscard]] bool has_visible_surfaces() const;
  /// Sky and environment, for guide rays.
  [[nodiscard]] glm::vec3 escaped(const glm::vec3& direction) const;
  /// The same for a ray from `from` of density `pdf`, each part times its weight against
  /// sample_local() (power heuristic; Veach 1997, eq. 9.13).
  [[nodiscard]] glm::vec3 escaped(const glm::vec3& from, const glm::vec3& direction,
                                  float pdf) const;

  [[nodiscard]] std::optional<ShapeHit> intersect(const Ray& ray) const;
  [[nodiscard]] bool occluded(const Ray& ray) const { return intersect(ray).has_value(); }
  /// Density with which sample_local() yields a ray that met a shape.
  [[nodiscard]] float pdf(const Ray& ray, const ShapeHit& hit) const;

  /// Radiance of emissive triangles against the ray, given their Material::emission.
  [[nodiscard]] glm::vec3 emitted(const glm::vec3& emission, const glm::vec3& ray_direction) const;
  /// Density with which sample_local() yields a ray that met a triangle.
  [[nodiscard]] float pdf(const Ray& ray, const Hit& hit) const;

  [[nodiscard]] const Lights& lights() const { return lights_; }

 private:
  struct SunDisk {
    float sine = 0.0f;  // of the half angle
    float rise = 0.0f;  // 1 - its cosine
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
  bool has_emissive_materials_ = false;   // also of those that emitters_ leaves out
  std::vector<glm::mat4> emitter_poses_;  // that emitters_ was made for
  Lights lights_;
  std::vector<SunDisk> disks_;  // of lights_.suns
};

/// Weight of a choice of density `pdf` where another way finds the same light with `other`.
[[nodiscard]] inline float power_heuristic(float pdf, float other) {
  if (!(other > 0.0f)) return 1.0f;
  const float ratio = other / pdf;  // first, as squares may overflow
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace eigenlight
