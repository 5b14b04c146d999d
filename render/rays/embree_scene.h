// Ray queries on the geometry of a scene: closest hits, occlusion and moving instances.
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

/// The points origin + t * direction with t in [t_min, t_max]. `direction` is a unit vector.
struct Ray {
  glm::vec3 origin{0.0f};
  glm::vec3 direction{0, 0, 1};
  float t_min = 0.0f;
  float t_max = std::numeric_limits<float>::infinity();
  /// A quick ray takes two thirds of the time but may pass between two triangles that share an
  /// edge. In a random direction that happens less than once in 100,000 rays. Rays aimed at points
  /// that may lie on edges must not be quick; these include rays through pixel centers.
  bool quick = false;
};

/// Intersection of a ray with triangle (a, b, c) at (1 - u - v) a + u b + v c.
struct Hit {
  float t = 0.0f;
  float u = 0.0f, v = 0.0f;
  std::uint32_t instance = 0;  ///< index into Scene::instances
  std::uint32_t triangle = 0;  ///< index into Mesh::triangles
  glm::vec3 normal{0.0f};      ///< geometric unit normal in world space; may face either side
};

class Quads;

/// A hit whose triangle, u and v still refer to a quad (quads.h).
struct QuadHit : Hit {
  const Quads* quads = nullptr;
};

/// All triangles of a scene, without light shapes. Queries may run on any number of threads; the
/// bits of a hit depend on the scene only.
///
/// Materials with an alpha cutoff have holes where the bilinear alpha of their texture is below the
/// cutoff. intersect() and occluded() ignore thin glass; glass_tint() returns its color.
class EmbreeScene {
 public:
  /// `scene` must outlive this and must not change. The last `moving` instances can be moved with
  /// set_poses(); all others are merged into one hierarchy. Throws std::invalid_argument if a mesh,
  /// material, texture or vertex index is out of range or `moving` exceeds the number of instances,
  /// and std::runtime_error if Embree fails.
  explicit EmbreeScene(const Scene& scene, std::size_t moving = 0);
  ~EmbreeScene();
  EmbreeScene(EmbreeScene&&) noexcept;
  EmbreeScene& operator=(EmbreeScene&&) noexcept;

  /// Sets the world transforms of the last `moving` instances. Does nothing if none has changed.
  /// Must not be called while rays are traced. Throws std::invalid_argument on another number of
  /// poses.
  void set_poses(std::span<const glm::mat4> poses);

  [[nodiscard]] std::optional<Hit> intersect(const Ray& ray) const;
  /// intersect() in two steps. intersect_quad() prefetches the memory that resolve_triangle()
  /// reads; trace other rays in between.
  [[nodiscard]] std::optional<QuadHit> intersect_quad(const Ray& ray) const;
  static void resolve_triangle(QuadHit& hit);
  [[nodiscard]] bool occluded(const Ray& ray) const;
  /// Product of the base colors of all thin glass between t_min and t_max; 1 without glass.
  [[nodiscard]] glm::vec3 glass_tint(const Ray& ray) const;
  [[nodiscard]] bool has_glass() const;

  /// Current world transforms of all instances.
  [[nodiscard]] std::span<const glm::mat4> transforms() const;
  /// Inverse transpose of the transform of an instance. It takes normals to world space without
  /// normalizing them.
  [[nodiscard]] const glm::mat3& normal_matrix(std::uint32_t instance) const;
  /// Factor by which the transform of an instance scales areas: exact for uniform scaling, else
  /// |det|^(2/3) as a mean.
  [[nodiscard]] float area_scale(std::uint32_t instance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace eigenlight
