// The command line as a function, so that tests can call it without a process.
#pragma once

#include <span>

#include "sequences/cli/console.h"

namespace eigenlight {

/// Exit statuses: 0; 1 where a file or the machine failed; 2 where the command line or a checkpoint
/// is to blame; kInterruptedStatus after Ctrl-C. Any failure is one line on `console.err`.
/// `args[0]` is the name of the program.
[[nodiscard]] int run_command_line(std::span<const char* const> args, Console console);

}  // namespace eigenlight
