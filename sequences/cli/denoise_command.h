// `eigenlight denoise`.
#pragma once

#include "sequences/cli/command.h"

namespace eigenlight {

[[nodiscard]] Command add_denoise_command(CLI::App& app);

}  // namespace eigenlight
