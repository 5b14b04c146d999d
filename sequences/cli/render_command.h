// `eigenlight render`: renders and denoises a flythrough.
#pragma once

#include "sequences/cli/console.h"
#include "sequences/runs/render_plan.h"

namespace eigenlight {

/// Runs it and returns the exit status: 0, or kInterruptedStatus after Ctrl-C, when the frame in
/// hand is complete, the checkpoint written and the command to go on printed. A checkpoint is also
/// written every ten seconds of rendering and at the end. Throws std::invalid_argument for a bad
/// option, CheckpointError for a checkpoint that must not be used, std::runtime_error for all else.
[[nodiscard]] int render_command(const RenderSettings& settings, const Console& console);

}  // namespace eigenlight
