// Guides of a pixel in 16 bytes, compared with those of any other pixel, of any frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "frame/frame.h"

namespace eigenlight {

/// (0, 10] Differences of guides that weigh a pixel by 1/e: of mean normals, of color, and of the
/// logarithm of depth. Found on two Cycles shots at 4 samples a pixel.
struct GuideWidths {
  float normal = 1.0f, color = 0.5f, depth = 0.5f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Steps of a packed value that make one width: rounding is far below the noise of guides, and
/// squares of the largest differences fit 32 bits.
inline constexpr float kGuideSteps = 256.0f;

/// Mean normal, color and log depth over their widths, in kGuideSteps.
struct PackedGuide {
  std::array<std::int16_t, 6> normal_color;
  std::int16_t depth;
  std::int16_t other;  ///< 0: a surface
};

[[nodiscard]] constexpr bool shows_surface(const PackedGuide& guide) { return guide.other == 0; }

/// Close to exp(-x), without a call: (1 - x/8)^8 up to x = 8, then 0.
[[nodiscard]] inline float falloff(float x) {
  const float a = std::max(1.0f - 0.125f * x, 0.0f);
  const float b = a * a, c = b * b;
  return c * c;
}

/// A difference of log depth in steps.
[[nodiscard]] inline std::int32_t depth_steps(float log_depth, const GuideWidths& widths) {
  return static_cast<std::int32_t>(std::clamp(log_depth / widths.depth, -60.0f, 60.0f) *
                                   kGuideSteps);
}

/// falloff(|a - b|^2), with `steps` added to the depth of a.
[[nodiscard]] inline float guide_weight(const PackedGuide& a, const PackedGuide& b,
                                        std::int32_t steps = 0) {
  std::int32_t sum = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::int32_t d = a.normal_color[i] - b.normal_color[i];
    sum += d * d;
  }
  const std::int32_t other = a.other - b.other;
  const auto depth = static_cast<float>(a.depth + steps - b.depth);
  return falloff((static_cast<float>(sum + other * other) + depth * depth) /
                 (kGuideSteps * kGuideSteps));
}

/// Packs the guides of a frame. An empty `mean_normal` stands for the normal; a guide that is not
/// finite is 0; a pixel without id, or whose depth is no positive number, is no surface.
void pack_guides(const FrameInput& frame, const GuideWidths& widths, Plane<PackedGuide>& out);

}  // namespace eigenlight
