// Ways of antialiasing on the same frames.
#pragma once

#include <optional>
#include <vector>

#include "sequences/compare/compare_run.h"

namespace eigenlight {

/// Measures each contender, all of which are ways of antialiasing, on the measured frames.
///
/// Error: the composed picture (direct and indirect light) of two renderings of `group.spp` samples
/// with seeds of their own, not denoised, against the two references of kAntialiasReference, over
/// all pixels. Noise of tests and references drops out, so that aliasing and blur are left. Cost:
/// of the frames as `render` makes them by default (3 samples, denoised by the default method,
/// after the frames of history).
///
/// Cells in the order of the contenders, or nothing if it was stopped. group.pictures get the mean
/// of both renderings as R,G,B.
[[nodiscard]] std::optional<std::vector<Cell>> run_antialias_group(const ComparePlan& plan,
                                                                   const CompareGroup& group,
                                                                   const RunControl& control);

}  // namespace eigenlight
