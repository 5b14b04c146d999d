// Distance from a point to the nearest surface of a scene.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Exact distances to the surfaces of a scene in its rest pose: all meshes, rectangle lights and
/// sphere lights. Uses a bounding volume hierarchy in world space. Queries may run on several
/// threads.
class Clearance {
 public:
  explicit Clearance(const Scene& scene);

  /// Distance from `point` to the nearest surface, at most `limit`, which may be +inf. Negative
  /// inside a sphere light.
  [[nodiscard]] float distance(const glm::vec3& point, float limit) const;

  /// Length of the cone from `origin` along the unit vector `direction` that touches no surface, at
  /// most `limit`. At distance d the radius of the cone is `slope` * d. Objects inside the cone are
  /// visible from `origin`. Sphere tracing (Hart 1996) of a cone.
  struct Cone {
    glm::vec3 origin{0.0f}, direction{0, 0, 1};
    float slope = 0.1f;
  };
  [[nodiscard]] float free_travel(const Cone& cone, float limit) const;

  /// Bounding box of all triangles.
  [[nodiscard]] const glm::vec3& lower() const { return lower_; }
  [[nodiscard]] const glm::vec3& upper() const { return upper_; }

 private:
  struct Triangle {
    glm::vec3 a, b, c;
  };
  struct Node {
    glm::vec3 lower{0.0f}, upper{0.0f};
    int first = 0;  ///< leaf: first triangle; inner node: left child, followed by the right child
    int count = 0;  ///< leaf: number of triangles; inner node: 0
  };

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
  void build(int node, int first, int count);

  std::vector<Triangle> triangles_;
  std::vector<SphereLight> spheres_;
  std::vector<Node> nodes_;
  glm::vec3 lower_{0.0f}, upper_{0.0f};
};

}  // namespace eigenlight
