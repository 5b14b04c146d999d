// Classifies triangles of a texture with holes as solid, hole or mixed.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

enum class Opacity : std::uint8_t {
  kSolid,  ///< bilinear_alpha() is nowhere below the cutoff
  kHole,   ///< bilinear_alpha() is below the cutoff everywhere
  kMixed,  ///< anything else, or unknown
};

/// Summed-area tables (Crow 1984) of one texture at one cutoff.
class OpacityMap {
 public:
  OpacityMap(const Texture& texture, float cutoff);

  /// Opacity of the triangle with the texture coordinates `uv`. Conservative: kMixed in doubt.
  [[nodiscard]] Opacity classify(const std::array<glm::vec2, 3>& uv) const;

 private:
  struct Counts {
    std::uint32_t solid = 0, hole = 0;  // number of such texels above and to the left
  };
  struct Span {
    int first = 0, count = 0;
  };
  [[nodiscard]] static Span touched(float low, float high, int size);
  [[nodiscard]] Counts count(const Span& x, const Span& y) const;  // without wrapping

  Extent extent_;
  std::vector<Counts> sums_;  // (width + 1) x (height + 1)
};

}  // namespace eigenlight
