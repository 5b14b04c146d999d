// Builds meshes from simple shapes for the built-in scenes.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Collects shapes into one mesh. Lengths are in meters; texture coordinates are in meters until
/// take() scales them. Quads and boxes take texture coordinates from the world axes, so that the
/// patterns of neighboring shapes line up. Normals face outward.
class MeshBuilder {
 public:
  /// Adds a quad with its corners in order. The normal points along cross(b - a, d - a).
  void quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);
  /// Adds a quad with texture coordinates (0, 0) at `top_left` and (1, 1) at `top_left` + `right` +
  /// `down`.
  void picture(const glm::vec3& top_left, const glm::vec3& right, const glm::vec3& down);
  /// Adds the six sides of an axis-aligned box.
  void box(const glm::vec3& lower, const glm::vec3& upper);

  /// Surface of revolution of a profile of (radius, height) around the y axis. Heights must ascend
  /// for outward normals. Profile edges sharper than 40 degrees stay sharp. The texture coordinate
  /// u spans 2 meters per turn, so that a pattern of 1 or 2 meters has no seam.
  struct Lathe {
    std::vector<glm::vec2> profile;
    int segments = 32;
    glm::vec3 foot{0.0f};
  };
  void lathe(const Lathe& shape);

  /// A wall of thickness `depth` around the plane z = 0, from height `spring` to `top`, with a
  /// round arch of `radius` cut out around x = 0.
  struct Arch {
    float half_width = 1.0f, radius = 0.8f, spring = 3.0f, top = 4.5f, depth = 0.5f;
    int segments = 24;
  };
  void arch(const Arch& shape);

  /// Adds a grid of `columns` x `rows` quads at point(u, v) for (u, v) in [0, 1]^2, with v = 0 at
  /// the top. Texture coordinates are (u, v). Normals are central differences, so `point` should be
  /// smooth.
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

  /// Adds a leaf: a quad around `center` with the given half sides.
  void leaf(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v);

  /// Returns the mesh and starts a new one. Texture coordinates are multiplied by `texture_scale`,
  /// in 1 / meters for tiled patterns.
  [[nodiscard]] Mesh take(const std::string& name, int material, float texture_scale = 1.0f);

 private:
  void add_grid(int columns, int rows, std::span<const glm::vec3> points);
  unsigned vertex(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv);
  void add_triangle(unsigned a, unsigned b, unsigned c) { mesh_.triangles.emplace_back(a, b, c); }

  Mesh mesh_;
};

}  // namespace eigenlight
