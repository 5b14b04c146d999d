#include "sequences/files/version.h"

namespace eigenlight {

std::string program_version() { return "eigenlight " EIGENLIGHT_VERSION; }

}  // namespace eigenlight
