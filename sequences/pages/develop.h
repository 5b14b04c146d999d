// From light to a picture for a screen.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "frame/plane.h"

namespace eigenlight {

/// sRGB(clamp(exposure * v, 0, 1)) as bytes, by table: 16384 steps are finer than a quarter of a
/// byte where the curve is steepest. Pixels with NaN or Inf become magenta.
class Developer {
 public:
  explicit Developer(float exposure);

  /// Means over blocks of factor x factor pixels; what is left over at right and bottom is cut off.
  [[nodiscard]] Plane<std::uint8_t> develop(const Planes<3>& colors, int factor) const;
  [[nodiscard]] static Extent shrunk(Extent extent, int factor);

 private:
  [[nodiscard]] std::uint8_t to_byte(float value) const;

  float exposure_;
  std::array<std::uint8_t, 16384> table_{};
};

}  // namespace eigenlight
