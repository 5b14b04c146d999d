// Geometry-aware lookup of indirect light.
#pragma once

#include <optional>

#include "render/antialias/guide_map.h"

namespace eigenlight {

/// The one of the four nearest guide rays whose hit is most like that of the eye ray (Bauszat,
/// Eisemann, Magnor 2011, Eq. 3-5):
///   s_i = (1 - |N - N_i|^2 / max_k |N - N_k|^2) * (1 - |D - D_i| / max_k |D - D_k|)
/// A maximum of 0 makes its factor 1: all are alike. Of equals the one nearest in the image is
/// taken, then the one further up and left.
///
/// Guide rays beyond the image, without a surface that reflects, or without finite indirect light
/// are not candidates, nor do they enter the maxima. Nothing if no candidate is left: the paper's
/// case (b) with no valid estimate at all.
[[nodiscard]] std::optional<glm::ivec2> most_similar_guide(const GuideMap& guides,
                                                           const EyePoint& eye);

}  // namespace eigenlight
