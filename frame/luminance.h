// Luminance of linear Rec. 709 colors.
#pragma once

#include <concepts>

#include "frame/plane.h"

namespace eigenlight {

/// Weights of red, green and blue.
inline constexpr double kLuminance[3] = {0.2126, 0.7152, 0.0722};

template <std::floating_point T>
[[nodiscard]] constexpr T luminance(T red, T green, T blue) {
  return static_cast<T>(kLuminance[0]) * red + static_cast<T>(kLuminance[1]) * green +
         static_cast<T>(kLuminance[2]) * blue;
}

/// Of pixel (x, y).
[[nodiscard]] inline float luminance(const Planes<3>& color, int x, int y) {
  return luminance(color[0](x, y), color[1](x, y), color[2](x, y));
}

}  // namespace eigenlight
