// Twin of reproject/warp: one value of one pixel, in double.
#pragma once

#include "reproject/taps.h"

namespace eigenlight::reference {

/// sum over the four taps of weight * value(x, y), for pixel i of a segment.
template <typename Value>
double warped(const TapSegment& taps, int i, const Value& value) {
  double sum = 0.0;
  for (int t = 0; t < 4; ++t) {
    const double weight = taps.weight[t][i];
    if (weight == 0.0) continue;  // may lie beside the image
    const glm::ivec2 tap = taps.tap(t, i);
    sum += weight * static_cast<double>(value(tap.x, tap.y));
  }
  return sum;
}

}  // namespace eigenlight::reference
