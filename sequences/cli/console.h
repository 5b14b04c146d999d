// Where a command speaks to.
#pragma once

#include <ostream>
#include <string>

namespace eigenlight {

struct Console {
  std::ostream& out;  ///< results
  std::ostream& err;  ///< progress, notes, errors
  bool err_is_terminal = false;
  std::string
      command_line;  ///< what the user typed, quoted for a shell (filled by run_command_line)
};

}  // namespace eigenlight
