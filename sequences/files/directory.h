// Directories for output.
#pragma once

#include <filesystem>

namespace eigenlight {

/// Makes a directory and those above it, unless they exist. Throws std::runtime_error naming the
/// path and the system's reason.
void make_directory(const std::filesystem::path& path);

}  // namespace eigenlight
