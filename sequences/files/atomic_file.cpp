#include "sequences/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace eigenlight {
namespace {

// Names of the temporary files being written, for remove_unfinished_file(). Plain storage, because
// a signal handler may read it at any moment; `is_named` says when the name is complete.
struct Unfinished {
  std::atomic<bool> is_taken{false}, is_named{false};
  char path[PATH_MAX];
};
std::array<Unfinished, 16> unfinished;

int take_slot() {
  for (std::size_t i = 0; i < unfinished.size(); ++i) {
    if (!unfinished[i].is_taken.exchange(true)) return static_cast<int>(i);
  }
  return -1;
}

Unfinished& slot_at(int slot) { return unfinished[static_cast<std::size_t>(slot)]; }

void release(int slot) {
  slot_at(slot).is_named = false;
  slot_at(slot).is_taken = false;
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target)
    : target_(target),
      path_(target.parent_path() / fmt::format(".{}.tmp", target.filename().string())) {
  const std::string name = path_.string();
  if (name.size() >= PATH_MAX) fail(ENAMETOOLONG);
  slot_ = take_slot();
  if (slot_ < 0) fail(EMFILE);
  std::memcpy(slot_at(slot_).path, name.c_str(), name.size() + 1);
  descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    const int error = errno;
    release(slot_);
    fail(error);
  }
  slot_at(slot_).is_named = true;
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (slot_ < 0) return;
  ::unlink(path_.c_str());
  release(slot_);
}

void AtomicFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::write_at(std::uint64_t position, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(position));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    position += static_cast<std::uint64_t>(written);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::commit() {
  // Some file systems report a full disk only on close.
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail(errno);
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail(errno);
  release(slot_);
  slot_ = -1;
}

void AtomicFile::fail(int error) const {
  throw std::runtime_error(
      fmt::format("{}: cannot write: {}", target_.string(), std::strerror(error)));
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

std::string read_whole_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw std::runtime_error(fmt::format("{}: cannot read: is a directory", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) {
    throw std::runtime_error(
        fmt::format("{}: cannot read: {}", path.string(), std::strerror(errno)));
  }
  return content;
}

void remove_unfinished_file() noexcept {
  for (const Unfinished& file : unfinished) {
    if (file.is_named) ::unlink(file.path);
  }
}

}  // namespace eigenlight
