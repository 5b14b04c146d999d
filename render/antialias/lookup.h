// Geometry-aware lookup of indirect light.
#pragma once

#include <optional>

#include "render/antialias/guide_map.h"

namespace eigenlight {

/// Pixel of the guide ray, among the four nearest ones, whose hit is most similar to that of the
/// camera ray `eye` (Bauszat, Eisemann, Magnor 2011, Eq. 3-5):
///   s_i = (1 - |N - N_i|^2 / max_k |N - N_k|^2) * (1 - |D - D_i| / max_k |D - D_k|)
/// A factor whose maximum is 0 is 1. Ties go to the pixel center nearest to `eye.pixel`, then to
/// the first in row order.
///
/// Guide rays outside the image, without a reflecting surface, or with non-finite indirect light
/// are not candidates and do not enter the maxima. Returns nullopt if there is no candidate: case
/// (b) of the paper without any valid estimate. With `seen`, neither are guide rays whose `values`
/// differ from `value`: points in the shadow for one in the sun.
struct SeenAlike {
  const Plane<std::uint8_t>& values;
  std::uint8_t value;
};
[[nodiscard]] std::optional<glm::ivec2> most_similar_guide(const GuideMap& guides,
                                                           const EyePoint& eye,
                                                           const SeenAlike* seen = nullptr);

}  // namespace eigenlight
