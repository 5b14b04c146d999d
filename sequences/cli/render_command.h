// `eigenlight render`: renders and denoises a flythrough.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

/// Exit status 0, or kInterrupted after Ctrl-C. An interrupted run completes the current frame,
/// writes its checkpoint and prints the command that goes on. A checkpoint is also written every
/// ten seconds of rendering and at the end. Throws std::invalid_argument for a bad option,
/// CheckpointError for a checkpoint that must not be used, std::runtime_error for all other errors.
[[nodiscard]] Command add_render_command(CLI::App& app);

}  // namespace eigenlight
