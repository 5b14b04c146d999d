// Pictures composed from albedo and light.
#pragma once

#include "frame/frame.h"

namespace eigenlight {

/// out = albedo * light, per pixel and channel. Throws std::invalid_argument if extents differ.
void modulate(const Planes<3>& albedo, const Planes<3>& light, Planes<3>& out);

/// out = albedo * (direct + indirect) + emission, with the given light and all else of `frame`.
void compose(const Frame& frame, const Planes<3>& indirect, const Planes<3>& direct,
             Planes<3>& out);
/// The same with the direct light of `frame`.
inline void compose(const Frame& frame, const Planes<3>& indirect, Planes<3>& out) {
  compose(frame, indirect, frame.direct, out);
}

}  // namespace eigenlight
