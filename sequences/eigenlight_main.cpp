#include <unistd.h>

#include <iostream>

#include "sequences/cli.h"

int main(int argc, char** argv) {
  const bool err_is_terminal = isatty(STDERR_FILENO) == 1;
  return eigenlight::run_command_line({argv, static_cast<std::size_t>(argc)},
                                      {std::cout, std::cerr, err_is_terminal, ""});
}
