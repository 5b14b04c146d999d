// Name and version of the program, as files record them.
#pragma once

#include <string>

namespace eigenlight {

/// "eigenlight" and the version, e.g. "eigenlight 0.1.0".
[[nodiscard]] std::string program_version();

}  // namespace eigenlight
