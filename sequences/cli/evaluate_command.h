// `eigenlight evaluate`: measures a sequence against its reference.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Prints a table: a column per pixel set, a row per figure. With --json it prints:
///   frames                number of frames that were measured
///   mean, young, old      means over frames; young and old only if there are such pixels
///   per_frame, skipped, bad_pixels
///   surface_from, age_from  where the pixel sets come from
/// Figures are named as in kMetricNames. A light step adds `step`, in `mean` `lag_frames` and
/// `lag_error` (Lag; relMSE x frames), and `step_reached` in `per_frame`. A figure that was not
/// measured is absent, and so is an infinite PSNR, which JSON cannot hold. Throws
/// std::runtime_error or std::invalid_argument.
[[nodiscard]] Command add_evaluate_command(CLI::App& app);

}  // namespace eigenlight
