// `eigenlight stress`: runs cases that must not break the denoiser.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Runs the cases (stress/stress_case.h) and prints a table, or with --json
///   {"cases": [{"name", "frames", "figure", "bound", "pass", "seconds", "what", "where"}, ..]}
/// (a figure that is not finite is null). --markdown FILE also writes the table to a file, below a
/// head with date, version and machine. A failing case is run again to record its worst frame in
/// a directory named after the case: the pictures of the frame before and of the worst frame
/// (before.exr, frame.exr), and the history that the worst frame met (state.bin). The command that
/// repeats the case is printed. Exit status kFailed if any case failed. Throws
/// std::invalid_argument listing the names if there is no such case.
[[nodiscard]] Command add_stress_command(CLI::App& app);

}  // namespace eigenlight
