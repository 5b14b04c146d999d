// From a hit to what light needs to know of the surface there.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"
#include "render/scene/texture_pyramid.h"

namespace eigenlight {

/// A point of a Lambertian surface, seen from one side.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 geometric{0.0f};  ///< unit normal of the triangle, towards the side it is seen from
  glm::vec3 normal{0.0f};     ///< unit, interpolated; `geometric` where that one faces away
  glm::vec3 albedo{0.0f};
  glm::vec3 origin{0.0f};  ///< where rays off the surface start, so as not to meet it again
};

/// Compact copies of what hits read: one record a triangle, prefiltered textures.
class SurfaceTable {
 public:
  /// `scene` and `geometry` must outlive this and must not change, but for poses.
  SurfaceTable(const Scene& scene, const EmbreeScene& geometry);
  SurfaceTable(const SurfaceTable&) = delete;
  SurfaceTable& operator=(const SurfaceTable&) = delete;

  /// The point of a guide ray; `spread` is the angle of its cone in radians (a pixel's), for the
  /// texture filter (ray cones; Akenine-Moller et al., Ray Tracing Gems, ch. 20).
  [[nodiscard]] SurfacePoint guide_point(const Ray& ray, const Hit& hit, float spread) const;
  /// The point that a bounce ray met. Its texture is the nearest texel of the level that fits a
  /// cone of kBounceSpread, whose color is still to be multiplied with albedo; null: none.
  struct BouncePoint {
    SurfacePoint point;
    const std::uint32_t* texel = nullptr;
  };
  [[nodiscard]] BouncePoint bounce_point(const Ray& ray, const Hit& hit) const;
  /// Asks memory for what bounce_point() will read.
  void prefetch(const Hit& hit) const {
    const auto& triangles = look_of_[hit.instance]->triangles;
    if (!triangles.empty()) __builtin_prefetch(&triangles[hit.triangle]);
  }

  /// Material::emission of the triangle that was hit: not yet scaled or tilted.
  [[nodiscard]] const glm::vec3& emission(const Hit& hit) const {
    return look_of_[hit.instance]->emission;
  }
  /// World position of the same point of the triangle under another transform of its instance.
  [[nodiscard]] glm::vec3 position(const Hit& hit, const glm::mat4& to_world) const;

  /// Radians. Diffuse bounces spread over the hemisphere; texture detail finer than this over their
  /// length is averaged out by the samples anyway, and reading it costs cache misses. Taste.
  static constexpr float kBounceSpread = 0.03f;

 private:
  struct alignas(64) Triangle {                          // one cache line: hits come from anywhere
    std::array<std::array<std::int16_t, 3>, 3> normals;  // of the corners, times 32767
    std::array<glm::vec2, 3> uv;
    float texels = 0.0f;  // texels per unit of area in the mesh's own space
  };
  struct Look {
    const Mesh* mesh = nullptr;
    glm::vec3 base_color{0.0f};
    glm::vec3 emission{0.0f};
    const TexturePyramid* texture = nullptr;  // null: plain
    bool smooth = false;                      // has vertex normals
    std::vector<Triangle> triangles;          // empty if neither smooth nor textured
  };
  [[nodiscard]] static Triangle make_triangle(const Look& look, const glm::uvec3& corners);
  [[nodiscard]] glm::vec3 shading_normal(const Hit& hit, const glm::vec3& geometric,
                                         const glm::vec3& view) const;
  [[nodiscard]] SurfacePoint point(const Ray& ray, const Hit& hit, const glm::vec3& position) const;
  /// Texels that the cone covers where it meets the triangle.
  [[nodiscard]] float footprint(const Ray& ray, const Hit& hit, float spread) const;

  const EmbreeScene* geometry_;
  std::vector<TexturePyramid> textures_;
  std::vector<Look> looks_;           // per mesh
  std::vector<const Look*> look_of_;  // per instance
};

}  // namespace eigenlight
