// One crop of each method side by side.
#pragma once

#include <cstdint>
#include <string>

#include "sequences/compare/compare_pictures.h"

namespace eigenlight {

/// The rectangle plan.crop of the last measured frame, of each contender in order and then of the
/// reference (the mean of both), at plan.shown_spp(). Rows of plan.crop->per_row crops, 4 black
/// pixels between them; small crops are enlarged by a whole factor. 3 bytes a pixel. The plan must
/// have a crop. Throws std::runtime_error naming a file that cannot be read.
[[nodiscard]] Plane<std::uint8_t> crop_rows(const ComparePictures& pictures);

/// What the crops show, in their order: `noisy, eigenlight, reference`.
[[nodiscard]] std::string crop_names(const ComparePlan& plan);

}  // namespace eigenlight
