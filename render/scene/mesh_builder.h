// Meshes from shapes: what the built-in scenes are made of.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Collects shapes into one mesh. Lengths are meters, and so are texture coordinates until take()
/// scales them; walls and floors get theirs from the world axes, so that patterns of neighboring
/// shapes line up. Normals face outward.
class MeshBuilder {
 public:
  /// Corners in order around the quad; the normal is along cross(b - a, d - a).
  void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);
  /// A quad with its own texture coordinates: 0, 0 (top left) at `top_left`, 1, 1 at
  /// `top_left` + `right` + `down`.
  void picture(const glm::vec3& top_left, const glm::vec3& right, const glm::vec3& down);
  /// All six sides.
  void box(const glm::vec3& lower, const glm::vec3& upper);

  /// Turns a profile of (radius, height) around the y axis; heights ascend for an outward normal.
  /// Edges of the profile sharper than 40 degrees stay sharp. Texture coordinates go once around in
  /// 2 "meters", so that a pattern of 1 or 2 meters has no seam.
  struct Lathe {
    std::vector<glm::vec2> profile;
    int segments = 32;
    glm::vec3 foot{0.0f};
  };
  void lathe(const Lathe& shape);

  /// A wall in the plane z = 0 of the given depth (half to each side), from the height `spring` to
  /// `top`, with a round arch of `radius` cut out around x = 0.
  struct Arch {
    float half_width = 1.0f, radius = 0.8f, spring = 3.0f, top = 4.5f, depth = 0.5f;
    int segments = 24;
  };
  void arch(const Arch& shape);

  /// A grid of `columns` x `rows` quads over (u, v) in [0, 1]^2, v = 0 at the top; texture
  /// coordinates are u, v. `point` is smooth: normals come from its neighbors.
  template <typename Point>
  void sheet(int columns, int rows, const Point& point) {
    std::vector<glm::vec3> points;
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= columns; ++i) {
        points.push_back(point(static_cast<float>(i) / static_cast<float>(columns),
                               static_cast<float>(j) / static_cast<float>(rows)));
      }
    }
    add_grid(columns, rows, points);
  }

  /// A leaf: a quad of the given half sides, seen from both sides.
  void leaf(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v);

  /// The mesh, with texture coordinates times `texture_scale` (1 / meters for tiled patterns).
  [[nodiscard]] Mesh take(const std::string& name, int material, float texture_scale = 1.0f);

 private:
  void add_grid(int columns, int rows, std::span<const glm::vec3> points);
  unsigned vertex(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv);

  Mesh mesh_;
};

}  // namespace eigenlight
