// `eigenlight judge-pyramid`: a table of the pyramid filter's trained weights.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Prints a table in Markdown. Throws Interrupted after Ctrl-C, std::invalid_argument for a bad
/// option, std::runtime_error for all other errors.
[[nodiscard]] Command add_judge_pyramid_command(CLI::App& app);

}  // namespace eigenlight
