// Whether a file was written to its end.
#pragma once

#include <filesystem>

namespace eigenlight {

/// True if `path` is an OpenEXR file and has all chunks of all of its parts. False if it is
/// missing, damaged or was not finished.
[[nodiscard]] bool is_complete_exr(const std::filesystem::path& path) noexcept;

}  // namespace eigenlight
