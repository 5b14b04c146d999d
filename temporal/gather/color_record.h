// Colors of a frame, kept for the frames around it.
#pragma once

#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

/// A color in 8 bytes: red, green and blue in steps of kColorStep. usable: 1, or 0 where a channel
/// is not finite or outside [0, kMostColor], for lamps and fireflies have no color to be steadied;
/// kCertainColor: other frames do not change it.
struct PackedColor {
  std::uint16_t r, g, b, usable;
};
using ColorRecord = Plane<PackedColor>;

inline constexpr std::uint16_t kCertainColor = 2;
inline constexpr float kMostColor = 2.0f;
/// Below what half floats tell apart near 1.
inline constexpr float kColorStep = kMostColor / 65535.0f;

void record_color(const Planes<3>& color, ColorRecord& record);

/// Light that surfaces send out themselves has no noise but at their edges, where it is as bright
/// as the share of samples that hit them. That share is a color:
///   record(p) = emission(p) / scale(p),
/// scale the largest channel of the pixels around p, or 1 where all are 0. A lamp that pulses
/// changes the scale and not the share. A share of none is certain: a hundredth of the
/// light of a lamp is many times that of the wall beside it.
void record_emission(const Planes<3>& emission, ColorRecord& record, Plane<float>& scale);

}  // namespace eigenlight
