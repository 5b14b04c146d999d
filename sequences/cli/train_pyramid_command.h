// `eigenlight train-pyramid`: the table of the pyramid filter's weights.
#pragma once

#include "sequences/cli/console.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds the sub-command, which trains when it is parsed: one line for each radius to `console.err`,
/// and the table, a C++ source, into the file of -o. Errors leave it as std::runtime_error or
/// std::invalid_argument. `console` must outlive `app`.
void add_train_pyramid_command(CLI::App& app, const Console& console);

}  // namespace eigenlight
