// Pictures composed from albedo and light.
#pragma once

#include "frame/frame.h"

namespace eigenlight {

/// out = albedo * light, per pixel and channel. Throws std::invalid_argument if extents differ.
void modulate(const Planes<3>& albedo, const Planes<3>& light, Planes<3>& out);

/// out = albedo * (direct + indirect) + emission of `frame`, with the given `indirect`.
void compose(const Frame& frame, const Planes<3>& indirect, Planes<3>& out);

}  // namespace eigenlight
