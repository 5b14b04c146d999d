// The command line as a function, so that tests can call it without a process.
#pragma once

#include <span>

#include "sequences/cli/console.h"

namespace eigenlight {

/// Parses and runs a command line; `args[0]` is the name of the program. Returns an ExitStatus
/// (command.h). Prints any error as one line on `console.err`. Status by exception:
/// std::invalid_argument and BadFile give kBadInput, Interrupted gives kInterrupted, all
/// others give kFailed, and so does output that cannot be written to `console.out`. Of an option
/// that is repeated the last value counts, unless the option takes a list.
[[nodiscard]] int run_command_line(std::span<const char* const> args, Console console);

}  // namespace eigenlight
