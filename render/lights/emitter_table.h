// All emissive triangles of a scene as one light.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/lights/distribution.h"
#include "render/rays/embree_scene.h"
#include "render/scene/scene.h"

namespace eigenlight {

/// Samples points on triangles whose material emits, with probability proportional to area *
/// luminance(emission). Leaves out thin glass, which no ray meets, and materials with holes, which
/// only cosine-distributed rays find.
class EmitterTable {
 public:
  EmitterTable() = default;
  /// Takes the triangles in world space at the current poses of `geometry`.
  EmitterTable(const Scene& scene, const EmbreeScene& geometry);

  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  /// Sum of area * luminance(emission).
  [[nodiscard]] float power() const { return static_cast<float>(distribution_.total()); }
  /// Sphere around all triangles.
  [[nodiscard]] const glm::vec3& center() const { return center_; }
  [[nodiscard]] float radius() const { return radius_; }

  struct Sample {
    glm::vec3 position{0.0f};
    glm::vec3 normal{0.0f};  ///< unit normal; may face either side
    glm::vec3 emission{0.0f};
    float pdf = 0.0f;  ///< per unit of area
  };
  /// `pick` in [0, 1) selects the triangle and `u` in [0, 1)^2 the point. Requires !empty().
  [[nodiscard]] Sample sample(float pick, const glm::vec2& u) const;
  /// Density per unit of area with which sample() returns a point on a triangle of the instance.
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
  std::vector<glm::vec3> emission_of_;  // per instance; 0 if not in the table
  std::vector<float> pdf_of_;           // per instance
  glm::vec3 center_{0.0f};
  float radius_ = 0.0f;
};

}  // namespace eigenlight
