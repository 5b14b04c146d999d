// Triangles taken two by two, for a hierarchy of half as many leaves.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Four corners 0 1 2 3 stand for triangles (0, 1, 3) and (2, 3, 1). A quad of one triangle has
/// corners 2 and 3 alike, so that the second has no area.
class Quads {
 public:
  /// Pairs those of the chosen triangles of `mesh` that share an edge, run through it in opposite
  /// directions, and fit into a box not much larger than their own. Others stay alone.
  Quads(const Mesh& mesh, std::span<const std::uint32_t> triangles);

  [[nodiscard]] std::span<const glm::uvec4> corners() const { return corners_; }

  /// A point of a triangle of the mesh: (1 - u - v) a + u b + v c.
  struct Point {
    std::uint32_t triangle = 0;
    float u = 0.0f, v = 0.0f;
  };
  /// The point of a quad where (1 - u - v) c0 + u c1 + v c3, beyond the diagonal
  /// (u + v - 1) c2 + (1 - u) c3 + (1 - v) c1.
  [[nodiscard]] Point point(std::uint32_t quad, float u, float v) const;
  /// The same point of what the corners hold.
  [[nodiscard]] static glm::vec2 interpolate(const std::array<glm::vec2, 4>& c, float u, float v) {
    if (u + v > 1.0f) return (u + v - 1.0f) * c[2] + (1.0f - u) * c[3] + (1.0f - v) * c[1];
    return (1.0f - u - v) * c[0] + u * c[1] + v * c[3];
  }
  /// Asks memory for what point() will read.
  void prefetch(std::uint32_t quad) const { __builtin_prefetch(&halves_[quad]); }

 private:
  // Triangle * 4 + how far its corners are turned in the quad: two bits.
  struct Halves {
    std::uint32_t first = 0, second = 0;
  };
  void add(const Mesh& mesh, std::uint32_t triangle);
  void add(const Mesh& mesh, std::uint32_t triangle, int side, std::uint32_t other, int other_side);

  std::vector<glm::uvec4> corners_;
  std::vector<Halves> halves_;
};

}  // namespace eigenlight
