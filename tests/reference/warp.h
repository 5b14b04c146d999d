// Twin of reproject/warp: one value of one pixel, in double.
#pragma once

#include "reproject/warp.h"

namespace eigenlight::reference {

/// sum over the four taps of weight * value(x, y), for pixel i of a segment.
template <typename Value>
double warped(const TapSegment& taps, std::size_t i, const Value& value) {
  double sum = 0.0;
  for (std::size_t t = 0; t < 4; ++t) {
    sum += static_cast<double>(taps.weight[t][i]) *
           static_cast<double>(value(taps.x[t][i], taps.y[t][i]));
  }
  return sum;
}

}  // namespace eigenlight::reference
