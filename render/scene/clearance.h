// How far a point is from the nearest surface.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Exact distances to the surfaces of a scene at rest: meshes of all kinds, area rects and sphere
/// lights. A bounding volume hierarchy in world space; queries are safe from several threads.
class Clearance {
 public:
  explicit Clearance(const Scene& scene);

  /// Distance from `point` to the nearest surface, or `limit` if there is none nearer. `limit` may
  /// be +inf. Inside a sphere light the distance is negative.
  [[nodiscard]] float distance(const glm::vec3& point, float limit) const;

  /// How far a ball that grows from nothing at `origin`, with radius `slope` times its distance,
  /// can move along the unit `direction` before it touches a surface; at most `limit`. Every
  /// smaller distance is free, and so is the whole cone up to there: what flies in it is seen from
  /// `origin`. Sphere tracing (Hart 1996) of a cone.
  struct Cone {
    glm::vec3 origin{0.0f}, direction{0, 0, 1};
    float slope = 0.1f;
  };
  [[nodiscard]] float free_travel(const Cone& cone, float limit) const;

  [[nodiscard]] std::size_t triangle_count() const { return triangles_.size(); }
  [[nodiscard]] const glm::vec3& lower() const { return lower_; }
  [[nodiscard]] const glm::vec3& upper() const { return upper_; }

 private:
  struct Triangle {
    glm::vec3 a, b, c;
  };
  struct Node {
    glm::vec3 lower{0.0f}, upper{0.0f};
    int first = 0;  ///< triangle of a leaf, or left child; the right child follows it
    int count = 0;  ///< triangles; 0 in inner nodes
  };

  void add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);
  void build(int node, int first, int count);

  std::vector<Triangle> triangles_;
  std::vector<SphereLight> spheres_;
  std::vector<Node> nodes_;
  glm::vec3 lower_{0.0f}, upper_{0.0f};
};

}  // namespace eigenlight
