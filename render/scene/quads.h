// Pairs triangles into quads, so that the ray hierarchy has half as many leaves.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// A quad with corners 0 1 2 3 holds the triangles (0, 1, 3) and (2, 3, 1). If it holds a single
/// triangle, corners 2 and 3 are equal and the second triangle has no area.
class Quads {
 public:
  /// Pairs the selected triangles of `mesh`. Two triangles are paired if they share an edge, have
  /// the same orientation, and their common bounding box is not much larger than their own boxes.
  /// All others form a quad of a single triangle.
  Quads(const Mesh& mesh, std::span<const std::uint32_t> triangles);

  [[nodiscard]] std::span<const glm::uvec4> corners() const { return corners_; }

  /// The point (1 - u - v) a + u b + v c of triangle (a, b, c) of the mesh.
  struct Point {
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
  };
  /// Converts a point of a quad to its triangle. The point is (1 - u - v) c0 + u c1 + v c3 where
  /// u + v <= 1, else (u + v - 1) c2 + (1 - u) c3 + (1 - v) c1.
  [[nodiscard]] Point point(std::uint32_t quad, float u, float v) const;
  /// Interpolates values `c` of the four corners at the same point.
  [[nodiscard]] static glm::vec2 interpolate(const std::array<glm::vec2, 4>& c, float u, float v) {
    if (u + v > 1.0f) return (u + v - 1.0f) * c[2] + (1.0f - u) * c[3] + (1.0f - v) * c[1];
    return (1.0f - u - v) * c[0] + u * c[1] + v * c[3];
  }
  /// Prefetches the memory that point() reads.
  void prefetch(std::uint32_t quad) const { __builtin_prefetch(&halves_[quad]); }

 private:
  // Each half is 4 * triangle + the index (0 to 2) of the triangle corner where the quad starts.
  struct Halves {
    std::uint32_t first = 0, second = 0;
  };
  void add(const Mesh& mesh, std::uint32_t triangle);
  void add(const Mesh& mesh, std::uint32_t triangle, int side, std::uint32_t other, int other_side);

  std::vector<glm::uvec4> corners_;
  std::vector<Halves> halves_;
};

}  // namespace eigenlight
