// Directories for output.
#pragma once

#include <filesystem>

namespace eigenlight {

/// Makes a directory and those above it, unless they exist. Throws std::runtime_error naming the
/// path and the system's reason.
void make_directory(const std::filesystem::path& path);

/// Keeps a directory for one run: while a lock lives, no other process gets one. It ends with the
/// process and leaves no file. Where a file system has no locks, none is taken.
class DirectoryLock {
 public:
  /// Throws std::runtime_error naming the directory if another process has it.
  explicit DirectoryLock(const std::filesystem::path& path);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace eigenlight
