// The taps of single points, for methods that look back by more than one frame.
#pragma once

#include <array>

#include "reproject/taps.h"

namespace eigenlight {

/// A point of a surface that is searched in an earlier frame.
struct SoughtPoint {
  std::uint32_t id = 0;
  glm::vec3 normal{0.0f};  ///< world space
  glm::vec2 pixel{0.0f};   ///< where it was, in units of pixel centers: whole numbers are pixels
  float depth = 0.0f;      ///< in that frame
};

/// Tells whether a tap of an earlier frame shows the point's surface, by the rule of
/// reproject/taps.h. A point that is not finite, or not in front of the camera, has no taps.
class TapRule {
 public:
  TapRule(const PreviousSurface& earlier, const TapOptions& options, const SoughtPoint& point);

  /// False where (x, y) lies outside the image.
  [[nodiscard]] bool accepts(int x, int y) const;

 private:
  const PreviousSurface& earlier_;
  const TapOptions& options_;
  const SoughtPoint& point_;
  glm::vec3 view_normal_;
  float plane_;  // N . X, in view space
  bool sound_;
};

/// Bilinear taps: tap t lies at corner + (t % 2, t / 2). Weights of accepted taps sum to 1, all are
/// 0 where fewer than 1 % of the weight is accepted; taps of weight 0 may lie outside the image.
struct PointTaps {
  glm::ivec2 corner{0};
  std::array<float, 4> weight{};

  [[nodiscard]] bool found() const { return weight[0] + weight[1] + weight[2] + weight[3] > 0.0f; }
  [[nodiscard]] glm::ivec2 tap(std::size_t t) const {
    return corner + glm::ivec2(static_cast<int>(t) % 2, static_cast<int>(t) / 2);
  }
};

[[nodiscard]] PointTaps point_taps(const PreviousSurface& earlier, const TapOptions& options,
                                   const SoughtPoint& point);

}  // namespace eigenlight
