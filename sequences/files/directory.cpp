#include "sequences/files/directory.h"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

namespace eigenlight {

void make_directory(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (std::filesystem::is_directory(path)) return;
  throw std::runtime_error(fmt::format("{}: cannot make the directory: {}", path.string(),
                                       error ? error.message() : "Not a directory"));
}

}  // namespace eigenlight
