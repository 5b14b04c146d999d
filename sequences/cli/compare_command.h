// `eigenlight compare`: run time against error, of many methods on the same noisy frames.
#pragma once

#include "sequences/cli/console.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Runs it and returns the exit status: 0, or kInterruptedStatus after Ctrl-C, when what is
/// complete (frames of references, methods at a sample count) is kept, and the same command goes
/// on from there. Writes into settings.directory:
///   index.html    the page (compare_page.h)
///   results.json  everything (compare_results.h)
///   results.csv   a line for each scene, method and sample count
///   frames/       the measured frames, SCENE/METHOD/frame.####.exr, at the sample count shown
///   cells/        results so far, each under the hash of all that decides it, the program included
/// Throws std::invalid_argument for a bad option, std::runtime_error for all else.
[[nodiscard]] int compare_command(const CompareSettings& settings, const Console& console);

}  // namespace eigenlight
