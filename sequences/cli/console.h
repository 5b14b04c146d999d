// The streams that a command writes to.
#pragma once

#include <ostream>
#include <string>

namespace eigenlight {

struct Console {
  std::ostream& out;  ///< results
  std::ostream& err;  ///< progress, notes, errors
  bool err_is_terminal = false;
  /// The command line, quoted for a shell. run_command_line() fills it in.
  std::string command_line = {};
};

}  // namespace eigenlight
