// How a sub-command joins the program: it adds its options to the parser and returns what runs it.
//
// A new sub-command NAME is NAME_command.h, which declares `Command add_NAME_command(CLI::App&)`,
// NAME_command.cpp, and one line in kCommands of cli.cpp.
#pragma once

#include <functional>

#include "sequences/cli/console.h"

namespace CLI {
class App;
}

namespace eigenlight {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kFailed = 1,         ///< a file or the machine failed: the same command may work later
  kBadInput = 2,       ///< the command line or a file is not what it must be
  kInterrupted = 130,  ///< Ctrl-C or SIGTERM: 128 + SIGINT
};

/// A sub-command.
struct Command {
  const CLI::App* parser;  ///< tells whether the user chose this sub-command
  /// Runs with the options that were parsed and returns an exit status. May throw:
  /// run_command_line() prints the error and chooses the status.
  std::function<int(const Console&)> run;
};

}  // namespace eigenlight
