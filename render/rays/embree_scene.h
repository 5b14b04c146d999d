// The geometry of a scene behind Embree: closest hits, occlusion, moving instances.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "render/scene/scene.h"

namespace eigenlight {

/// Points origin + t * direction, t in [t_min, t_max]. `direction` is unit.
struct Ray {
  glm::vec3 origin{0.0f};
  glm::vec3 direction{0, 0, 1};
  float t_min = 0.0f;
  float t_max = std::numeric_limits<float>::infinity();
  /// May slip between two triangles that share an edge, which a ray in a random direction does less
  /// than once in 100,000; in return it takes two thirds of the time. Not for rays that are aimed
  /// at places which may lie on edges, pixel centers among them.
  bool quick = false;
};

/// Where a ray met a triangle: (1 - u - v) a + u b + v c.
struct Hit {
  float t = 0.0f;
  float u = 0.0f, v = 0.0f;
  std::uint32_t instance = 0;  ///< index into Scene::instances
  std::uint32_t triangle = 0;  ///< index into Mesh::triangles
  glm::vec3 normal{0.0f};      ///< geometric, unit, world space, of either side
};

class Quads;

/// A hit whose triangle, u and v are still to be looked up: they are those of a quad (quads.h).
struct QuadHit : Hit {
  const Quads* quads = nullptr;
};

/// All triangles of a scene, ready for rays. Safe to trace from any number of threads; the bits of
/// a hit depend on the scene alone, not on threads. Light shapes are not part of it.
///
/// Materials with an alpha cutoff have holes where the bilinear alpha of the texture is below it.
/// Thin glass is passed by intersect() and occluded(); glass_tint() tells its color.
class EmbreeScene {
 public:
  /// `scene` must outlive this and must not change. The last `moving` instances may be moved with
  /// set_poses(); the others are merged into one hierarchy. Throws std::invalid_argument if an
  /// index of the scene (mesh, material, texture, vertex) is out of range or `moving` exceeds the
  /// instances, std::runtime_error if Embree fails.
  explicit EmbreeScene(const Scene& scene, std::size_t moving = 0);
  ~EmbreeScene();
  EmbreeScene(EmbreeScene&&) noexcept;
  EmbreeScene& operator=(EmbreeScene&&) noexcept;

  /// World transforms of the last `moving` instances; costs nothing if none has changed. Not to be
  /// called while rays are traced. Throws std::invalid_argument on another count.
  void set_poses(std::span<const glm::mat4> poses);

  [[nodiscard]] std::optional<Hit> intersect(const Ray& ray) const;
  /// The same in two steps, for memory is asked for what the second reads: it should come when
  /// other rays have been traced.
  [[nodiscard]] std::optional<QuadHit> find(const Ray& ray) const;
  static void look_up(QuadHit& hit);
  [[nodiscard]] bool occluded(const Ray& ray) const;
  /// Product of the base colors of all thin glass between t_min and t_max; 1 where there is none.
  [[nodiscard]] glm::vec3 glass_tint(const Ray& ray) const;
  [[nodiscard]] bool has_glass() const;

  /// Current world transforms of all instances.
  [[nodiscard]] std::span<const glm::mat4> transforms() const;
  /// Inverse transpose of an instance's transform: takes its normals to the world (not unit).
  [[nodiscard]] const glm::mat3& normal_matrix(std::uint32_t instance) const;
  /// How much an instance's transform enlarges areas: exact for uniform scales, a mean for others.
  [[nodiscard]] float area_scale(std::uint32_t instance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace eigenlight
