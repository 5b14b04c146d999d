#include "sequences/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

namespace eigenlight {
namespace {

// Name of the temporary file being written, for remove_unfinished_file(). Plain storage, because a
// signal handler may read it at any moment; the flag says when it is complete.
char unfinished_path[PATH_MAX];
std::atomic<bool> is_unfinished{false};

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(target),
        path_(target.parent_path() / fmt::format(".{}.tmp", target.filename().string())) {
    const std::string name = path_.string();
    if (name.size() >= sizeof(unfinished_path)) fail(ENAMETOOLONG);
    std::memcpy(unfinished_path, name.c_str(), name.size() + 1);
    descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(errno);
    is_unfinished = true;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (is_unfinished) ::unlink(path_.c_str());
    is_unfinished = false;
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(errno);
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void commit() {
    // Some file systems report a full disk only on close.
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail(errno);
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail(errno);
    is_unfinished = false;
  }

 private:
  [[noreturn]] void fail(int error) const {
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", target_.string(), std::strerror(error)));
  }

  std::filesystem::path target_, path_;
  int descriptor_ = -1;
};

}  // namespace

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  TemporaryFile file(path);
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
  if (is_unfinished) ::unlink(unfinished_path);
}

}  // namespace eigenlight
