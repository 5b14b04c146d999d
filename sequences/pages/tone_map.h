// From linear light to the 8-bit values of a screen.
#pragma once

#include <array>
#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

/// sRGB(clamp(exposure * v, 0, 1)), rounded to 8 bits. Looked up in a table of 16384 steps, which
/// are finer than a quarter of an 8-bit step where the curve is steepest.
class ToneMap {
 public:
  explicit ToneMap(float exposure);

  /// A picture of 3 bytes a pixel. Each pixel is the mean of factor x factor pixels of `colors`;
  /// pixels left over at the right and at the bottom are cut off. Means that are NaN or Inf become
  /// magenta.
  [[nodiscard]] Plane<std::uint8_t> apply(const Planes<3>& colors, int factor) const;

  /// The size of that picture: extent / factor, at least 1 x 1.
  [[nodiscard]] static Extent shrunk(Extent extent, int factor);

 private:
  [[nodiscard]] std::uint8_t to_byte(float value) const;

  float exposure_;
  std::array<std::uint8_t, 16384> table_{};
};

}  // namespace eigenlight
