// Luminance of linear Rec. 709 colors.
#pragma once

#include "frame/plane.h"

namespace eigenlight {

/// Of pixel (x, y).
[[nodiscard]] inline float luminance(const Planes<3>& color, int x, int y) {
  return 0.2126f * color[0](x, y) + 0.7152f * color[1](x, y) + 0.0722f * color[2](x, y);
}

}  // namespace eigenlight
