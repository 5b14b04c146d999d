// `eigenlight scenes` and `eigenlight methods [--parts]`.
#pragma once

#include <ostream>

#include "sequences/cli/command.h"

namespace eigenlight {

[[nodiscard]] Command add_scenes_command(CLI::App& app);
[[nodiscard]] Command add_methods_command(CLI::App& app);

/// Built-in scenes, one line each.
void list_scenes(std::ostream& out);

/// Methods, one line each, with the paper they come from.
void list_methods(std::ostream& out);

/// Each method that has parts to turn off; below it, one line for each part.
void list_parts(std::ostream& out);

}  // namespace eigenlight
