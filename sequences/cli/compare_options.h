// The options of `eigenlight compare`.
#pragma once

#include "sequences/cli/job.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

struct CompareOptions {
  CompareSettings settings;
  JobOptions job;
};

/// Adds the options to the sub-command. `options` must outlive it.
void add_compare_options(CLI::App& command, CompareOptions& options);

}  // namespace eigenlight
