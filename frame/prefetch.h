// Asking for memory before it is needed.
#pragma once

#include "frame/plane.h"

namespace eigenlight {

/// Asks for the line under pixel (x, y) in the next row of `plane`: for nothing under the last one.
/// Rows of a strip (frame/strips.h) are too short for the hardware to foresee where the next
/// begins. To be called vector by vector between other work: many at a time only queue up.
template <typename T>
void prefetch_below(const Plane<T>& plane, int x, int y) {
  if (y + 1 < plane.height()) __builtin_prefetch(plane.at(x, y + 1));
}

}  // namespace eigenlight
