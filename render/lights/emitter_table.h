// Emissive triangles as one light.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/lights/distribution.h"
#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// All triangles whose material emits, chosen in proportion to area * luminance(emission). Left out
/// are thin glass, which no ray meets, and materials with holes, which only bounce rays find.
class EmitterTable {
 public:
  EmitterTable() = default;
  /// Triangles in world space at the current poses of `geometry`.
  EmitterTable(const Scene& scene, const EmbreeScene& geometry);

  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Sum of area * luminance(emission).
  [[nodiscard]] float power() const { return static_cast<float>(distribution_.total()); }
  /// A sphere around all of them.
  [[nodiscard]] const glm::vec3& center() const { return center_; }
  [[nodiscard]] float radius() const { return radius_; }

  struct Sample {
    glm::vec3 position{0.0f};
    glm::vec3 normal{0.0f};  ///< unit, of either side
    glm::vec3 emission{0.0f};
    float pdf = 0.0f;  ///< per area
  };
  /// `pick` chooses the triangle, `u` the point on it. Requires !empty().
  [[nodiscard]] Sample sample(float pick, const glm::vec2& u) const;
  /// Density per area with which sample() yields a point of a triangle of this instance.
  [[nodiscard]] float pdf(std::uint32_t instance) const { return pdf_of_[instance]; }

 private:
  struct Triangle {
    glm::vec3 corner, edge_u, edge_v;
    std::uint32_t instance;
  };
  void add(const Scene& scene, std::uint32_t instance, const glm::mat4& to_world);
  void bound();

  std::vector<Triangle> triangles_;
  Distribution distribution_;
  std::vector<glm::vec3> emission_of_;  // per instance; 0: not in the table
  std::vector<float> pdf_of_;           // per instance
  glm::vec3 center_{0.0f};
  float radius_ = 0.0f;
};

}  // namespace eigenlight
