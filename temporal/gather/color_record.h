// Colors of a frame, kept for the frames around it.
#pragma once

#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

/// A color in 8 bytes: red, green and blue in steps of kColorStep. usable: 1, or 0 where a channel
/// is not finite or outside [0, kMostColor]; lamps and fireflies have no color to be steadied.
struct PackedColor {
  std::uint16_t r, g, b, usable;
};
using ColorRecord = Plane<PackedColor>;

inline constexpr float kMostColor = 2.0f;
/// Below what half floats tell apart near 1.
inline constexpr float kColorStep = kMostColor / 65535.0f;

void record_color(const Planes<3>& color, ColorRecord& record);

}  // namespace eigenlight
