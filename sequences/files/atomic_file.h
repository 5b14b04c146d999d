// Files that are written completely or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace eigenlight {

/// A file being written under a temporary name beside its target (`.name.tmp`), which commit()
/// renames to the target. Without that the temporary file is removed, and an older file at the
/// target stays. All members throw std::runtime_error naming the target and the system's reason.
/// At most 16 at a time, of different targets.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& target);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  void write(std::string_view bytes);  ///< behind what was written last
  void write_at(std::uint64_t position, std::string_view bytes);
  /// There is no fsync: this guards against a full disk and a stopped process, not against a power
  /// cut.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path target_, path_;
  int slot_ = -1, descriptor_ = -1;
};

/// Writes `bytes` to `path` as an AtomicFile.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The whole content of a file. Throws std::runtime_error naming the path and the reason.
[[nodiscard]] std::string read_whole_file(const std::filesystem::path& path);

/// Removes the temporary files of unfinished writes. Async-signal-safe, for a handler that ends
/// the process.
void remove_unfinished_file() noexcept;

}  // namespace eigenlight
