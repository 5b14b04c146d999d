// `eigenlight train-pyramid`: fits the weights of the pyramid filter.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Prints one line for each radius and writes the table, a C++ source, to the file of -o. Throws
/// Interrupted after Ctrl-C, with nothing written, std::invalid_argument for a bad option,
/// std::runtime_error for all other errors.
[[nodiscard]] Command add_train_pyramid_command(CLI::App& app);

}  // namespace eigenlight
