// Pictures painted by code, so that training needs no files.
#pragma once

#include <cstdint>

#include "frame/plane.h"

namespace eigenlight {

/// Discs, bars and checkerboards of flat, shaded or grainy color before a cloudy ground: edges of
/// all directions and contrasts, gradients, and texture of several scales. Values in [0, 1].
/// Each `seed` gives another picture, with the same bits on every machine.
[[nodiscard]] Planes<3> paint_training_image(Extent extent, std::uint32_t seed);

}  // namespace eigenlight
