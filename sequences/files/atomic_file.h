// Files that are written completely or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace eigenlight {

/// Writes `bytes` to a temporary file beside `path` (`.name.tmp`), then renames it to `path`. If
/// that fails, the temporary file is removed, an older file at `path` stays, and std::runtime_error
/// names the path and the system's reason. There is no fsync: this guards against a full disk and a
/// stopped process, not against a power cut. One call at a time per process.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The whole content of a file. Throws std::runtime_error naming the path and the reason.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// Removes the temporary file of an unfinished write. Async-signal-safe, for a handler that ends
/// the process.
void remove_unfinished_file() noexcept;

}  // namespace eigenlight
