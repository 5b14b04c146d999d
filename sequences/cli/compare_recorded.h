// `eigenlight compare` on the frames of another renderer.
#pragma once

#include "sequences/cli/job.h"
#include "sequences/compare/compare_plan.h"

namespace eigenlight {

/// Runs the contenders one after the other (recorded_run.h), keeps the figures of each, and writes
/// what compare_command.h lists. The same command goes on after Ctrl-C or a crash. Returns kSuccess
/// or kInterrupted; throws as make_recorded_plan(), plan_denoising() and RecordedRun do.
[[nodiscard]] int compare_recorded(const CompareSettings& settings, const Job& job);

}  // namespace eigenlight
