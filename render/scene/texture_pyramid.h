// Base color textures, prefiltered for the width that a ray has where it lands.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/scene/scene.h"

namespace eigenlight {

/// Alpha in [0, 1] of a texture at full resolution, bilinear; `uv` repeats.
[[nodiscard]] float bilinear_alpha(const Texture& texture, const glm::vec2& uv);

/// A texture and its halvings down to 1x1 (Williams 1983), 8-bit sRGB, averaged in linear light.
/// Colors are weighted by alpha, so that what a hole hides does not bleed into its rim.
class TexturePyramid {
 public:
  explicit TexturePyramid(const Texture& texture);

  [[nodiscard]] Extent extent() const { return levels_.front().extent; }
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }

  /// Linear color, trilinear. `level` 0 is full resolution and is clamped to the levels there are;
  /// `uv` repeats. For guide rays, which must not flicker under motion.
  [[nodiscard]] glm::vec3 trilinear(const glm::vec2& uv, float level) const;
  /// Linear color of the nearest texel of one level (clamped). For bounce rays: one memory access.
  [[nodiscard]] glm::vec3 nearest(const glm::vec2& uv, int level) const {
    return color(nearest_texel(uv, level));
  }
  /// The same in two steps, so that memory can be asked for the texel ahead of time.
  [[nodiscard]] const std::uint32_t& nearest_texel(const glm::vec2& uv, int level) const;
  [[nodiscard]] static glm::vec3 color(std::uint32_t texel);

 private:
  struct Level {
    Extent extent;
    std::vector<std::uint32_t> texels;  // r, g, b, a from the lowest byte
  };
  [[nodiscard]] static Level halve(const Level& fine);
  [[nodiscard]] static glm::vec3 bilinear(const Level& level, const glm::vec2& uv);

  std::vector<Level> levels_;
};

}  // namespace eigenlight
