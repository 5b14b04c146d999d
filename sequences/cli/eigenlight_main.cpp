#include <unistd.h>

#include <iostream>

#include "frame/float_traps.h"
#include "sequences/cli/cli.h"

int main(int argc, char** argv) {
  eigenlight::trap_float_faults();
  const bool err_is_terminal = isatty(STDERR_FILENO) == 1;
  return eigenlight::run_command_line({argv, static_cast<std::size_t>(argc)},
                                      {std::cout, std::cerr, err_is_terminal, ""});
}
