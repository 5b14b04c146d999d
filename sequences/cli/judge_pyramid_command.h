// `eigenlight judge-pyramid`: a table of the pyramid filter's trained weights.
#pragma once

#include "sequences/cli/console.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds the sub-command, which judges when it is parsed and prints a table in Markdown to
/// `console.out`. `console` must outlive `app`.
void add_judge_pyramid_command(CLI::App& app, const Console& console);

}  // namespace eigenlight
