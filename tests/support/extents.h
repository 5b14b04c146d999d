// Image sizes that tests run through.
#pragma once

#include <array>

#include "frame/plane.h"

namespace eigenlight {

/// One pixel, less than a vector, whole stage tiles, one pixel more than these, and odd sizes.
inline constexpr std::array<Extent, 5> kSweepExtents{
    {{1, 1}, {5, 3}, {64, 16}, {65, 17}, {191, 107}}};

}  // namespace eigenlight
