// Base color textures prefiltered for the footprint of a ray (mipmaps).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Bilinear alpha in [0, 1] of a texture at full resolution; `uv` repeats.
[[nodiscard]] float bilinear_alpha(const Texture& texture, const glm::vec2& uv);

/// A texture and its mipmap levels down to 1x1 (Williams 1983) in 8-bit sRGB, averaged in linear
/// light. Colors are weighted by alpha, so that the invisible color of holes does not bleed into
/// their rims.
class TexturePyramid {
 public:
  explicit TexturePyramid(const Texture& texture);

  [[nodiscard]] Extent extent() const { return levels_.front().extent; }
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }

  /// Trilinear linear color for guide rays, which must not flicker under motion. Level 0 is full
  /// resolution; `level` is clamped to the existing levels. `uv` repeats.
  [[nodiscard]] glm::vec3 trilinear(const glm::vec2& uv, float level) const;
  /// Linear color of the nearest texel of one level for bounce rays: one memory access. `level` is
  /// clamped.
  [[nodiscard]] glm::vec3 nearest(const glm::vec2& uv, int level) const {
    return color(nearest_texel(uv, level));
  }
  /// nearest() in two steps, so that the texel can be prefetched.
  [[nodiscard]] const std::uint32_t& nearest_texel(const glm::vec2& uv, int level) const;
  [[nodiscard]] static glm::vec3 color(std::uint32_t texel);

 private:
  struct Level {
    Extent extent;
    std::vector<std::uint32_t> texels;  // r, g, b, a from the lowest byte on
  };
  [[nodiscard]] static Level halve(const Level& fine);
  [[nodiscard]] static glm::vec3 bilinear(const Level& level, const glm::vec2& uv);

  std::vector<Level> levels_;
};

}  // namespace eigenlight
