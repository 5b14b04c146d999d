// Position, normals and albedo of the surface at a hit.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"
#include "render/scene/texture_pyramid.h"

namespace eigenlight {

/// A point of a Lambertian surface and the side it is seen from.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 geometric{0.0f};  ///< unit normal of the triangle on the visible side
  glm::vec3 normal{0.0f};     ///< interpolated unit normal; `geometric` if that faces away
  glm::vec3 albedo{0.0f};
  glm::vec3 origin{0.0f};  ///< start of rays that leave the surface, offset to avoid meeting it
};

/// Compact copies of the data that hits read: one record per triangle and prefiltered textures.
class SurfaceTable {
 public:
  /// `scene` and `geometry` must outlive this. Only the poses of `geometry` may change.
  SurfaceTable(const Scene& scene, const EmbreeScene& geometry);
  SurfaceTable(const SurfaceTable&) = delete;
  SurfaceTable& operator=(const SurfaceTable&) = delete;

  /// Surface at the hit of a guide ray. `spread` is the cone angle of one pixel in radians for the
  /// texture filter (ray cones; Akenine-Moller et al., Ray Tracing Gems, ch. 20).
  [[nodiscard]] SurfacePoint guide_point(const Ray& ray, const Hit& hit, float spread) const;
  /// Surface at the hit of a bounce ray. `texel` is the nearest texel in the texture level that
  /// fits a cone of kBounceSpread; the caller multiplies albedo by its color. Null: no texture.
  struct BouncePoint {
    SurfacePoint point;
    const std::uint32_t* texel = nullptr;
  };
  [[nodiscard]] BouncePoint bounce_point(const Ray& ray, const Hit& hit) const;
  /// Prefetches the memory that bounce_point() reads.
  void prefetch(const Hit& hit) const {
    const auto& triangles = appearance_of_[hit.instance]->triangles;
    if (!triangles.empty()) __builtin_prefetch(&triangles[hit.triangle]);
  }

  /// Material::emission of the triangle, before Lights::emissive_scale and emissive_tilt.
  [[nodiscard]] const glm::vec3& emission(const Hit& hit) const {
    return appearance_of_[hit.instance]->emission;
  }
  /// World position that the hit point of the triangle has under the transform `to_world`.
  [[nodiscard]] glm::vec3 position(const Hit& hit, const glm::mat4& to_world) const;

  /// Cone angle in radians that selects the texture level of bounces. Averaging over diffuse
  /// bounces removes finer texture detail, and reading it costs cache misses. Chosen by eye.
  static constexpr float kBounceSpread = 0.03f;

 private:
  struct alignas(64) Triangle {                          // one cache line, as access is random
    std::array<std::array<std::int16_t, 3>, 3> normals;  // at the corners, times 32767
    std::array<glm::vec2, 3> uv;
    float texels = 0.0f;  // texels per unit of area in mesh space
  };
  struct Appearance {
    const Mesh* mesh = nullptr;
    glm::vec3 base_color{0.0f};
    glm::vec3 emission{0.0f};
    const TexturePyramid* texture = nullptr;  // null: no texture
    bool smooth = false;                      // the mesh has vertex normals
    std::vector<Triangle> triangles;          // empty without vertex normals and texture
  };
  [[nodiscard]] static Triangle make_triangle(const Appearance& appearance,
                                              const glm::uvec3& corners);
  [[nodiscard]] glm::vec3 shading_normal(const Hit& hit, const glm::vec3& geometric,
                                         const glm::vec3& view) const;
  [[nodiscard]] SurfacePoint point(const Ray& ray, const Hit& hit, const glm::vec3& position) const;
  /// Number of texels that the cone covers on the triangle.
  [[nodiscard]] float footprint(const Ray& ray, const Hit& hit, float spread) const;

  const EmbreeScene* geometry_;
  std::vector<TexturePyramid> textures_;
  std::vector<Appearance> appearances_;           // per mesh
  std::vector<const Appearance*> appearance_of_;  // per instance
};

}  // namespace eigenlight
