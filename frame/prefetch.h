// Prefetches memory that is needed soon.
#pragma once

#include "frame/plane.h"

namespace eigenlight {

/// Prefetches the cache line below pixel (x, y) of `plane`; nothing below its last row.
/// Rows of a strip (frame/strips.h) are too short for the hardware to find the next one by itself.
/// Call it vector by vector between other work: many prefetches at a time only queue up.
template <typename T>
void prefetch_below(const Plane<T>& plane, int x, int y) {
  if (y + 1 < plane.height()) __builtin_prefetch(plane.at(x, y + 1));
}

}  // namespace eigenlight
