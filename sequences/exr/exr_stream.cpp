#include "sequences/exr/exr_stream.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfThreading.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <new>
#include <stdexcept>

#include "frame/bad_file.h"
#include "frame/float_traps.h"
#include "frame/tiles.h"
#include "sequences/exr/exr_file.h"

namespace eigenlight {
namespace {

constexpr std::size_t kBuffer = 1 << 16;

[[noreturn]] void fail(const std::filesystem::path& path, const char* reason) {
  throw std::runtime_error(fmt::format("{}: cannot read: {}", path.string(), reason));
}

// OpenEXR puts sentences that name the file in front of the reason: `Cannot read image file "PATH".
// REASON`.
std::string reason_of(const std::string& text, const std::string& path) {
  std::string reason = text;
  const std::string named = fmt::format("\"{}\". ", path);
  const std::size_t last = text.rfind(named);
  if (last != std::string::npos && last + named.size() < text.size()) {
    reason = text.substr(last + named.size());
  }
  // Names in damaged headers may hold anything.
  std::replace_if(
      reason.begin(), reason.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; }, ' ');
  while (reason.ends_with('.') || reason.ends_with(' ')) reason.pop_back();
  return reason;
}

}  // namespace

ExrInput::ExrInput(const std::filesystem::path& path) : IStream(path.c_str()) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw std::runtime_error(fmt::format("{}: no such file", path.string()));
  }
  // Not a pipe, which would wait for its other end.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) fail(path, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) {
    ::close(descriptor_);
    throw BadFile(fmt::format("{}: cannot read: {}", path.string(),
                              S_ISDIR(status.st_mode) ? "is a directory" : "not a regular file"));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

ExrInput::~ExrInput() { ::close(descriptor_); }

void ExrInput::read_at(std::uint64_t position, void* to, std::size_t count) const {
  if (position > size_ || count > size_ - position) throw Iex::InputExc("the file ends early");
  char* next = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = ::pread(descriptor_, next, count, static_cast<off_t>(position));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw Iex::InputExc(std::strerror(errno));
    if (got == 0) throw Iex::InputExc("the file ends early");
    next += got;
    position += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

bool ExrInput::read(char to[], int count) {
  const auto wanted = static_cast<std::uint64_t>(std::max(count, 0));
  if (wanted > kBuffer / 4) {
    read_at(position_, to, wanted);
  } else {
    if (position_ < buffer_start_ || position_ + wanted > buffer_start_ + buffer_.size()) {
      if (position_ >= size_) throw Iex::InputExc("the file ends early");
      buffer_.resize(std::min<std::uint64_t>(kBuffer, size_ - position_));
      buffer_start_ = position_;
      read_at(position_, buffer_.data(), buffer_.size());
      if (wanted > buffer_.size()) throw Iex::InputExc("the file ends early");
    }
    std::memcpy(to, buffer_.data() + (position_ - buffer_start_), wanted);
  }
  position_ += wanted;
  return position_ < size_;
}

void with_exr_errors(const std::filesystem::path& path, const std::string& what,
                     const std::function<void()>& work) {
  const auto failed = [&](const std::string& reason) {
    throw std::runtime_error(fmt::format("{}: {}: {}", path.string(), what, reason));
  };
  try {
    work();
  } catch (const Iex::BaseExc& error) {
    failed(reason_of(error.what(), path.string()));
  } catch (const std::bad_alloc&) {
    failed("not enough memory");
  } catch (const std::length_error&) {
    failed("not enough memory");
  }
}

void use_our_threads_for_exr() {
  static std::mutex mutex;
  static int current = -1;
  const std::lock_guard lock(mutex);
  if (current == thread_count()) return;
  current = thread_count();
  const FloatTrapsOff threads_start_here;
  // Without a pool, OpenEXR works on the calling thread.
  Imf::setGlobalThreadCount(current == 1 ? 0 : current);
}

}  // namespace eigenlight
