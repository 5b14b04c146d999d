// The command line of `eigenlight compare`.
#pragma once

#include "sequences/compare/compare_plan.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Adds the sub-command, whose options end up in `settings`, which must outlive `app`.
[[nodiscard]] const CLI::App* add_compare_command(CLI::App& app, CompareSettings& settings);

}  // namespace eigenlight
