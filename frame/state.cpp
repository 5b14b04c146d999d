#include "frame/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>

namespace eigenlight {
namespace {

[[noreturn]] void fail(std::string_view name, std::string_view what) {
  throw std::runtime_error(fmt::format("state of '{}': {}", name, what));
}

}  // namespace

void StateWriter::raw(const void* data, std::size_t size) {
  const char* begin = static_cast<const char*>(data);
  bytes_.insert(bytes_.end(), begin, begin + size);
}

void StateWriter::block(std::string_view name, const void* data, std::size_t size) {
  const auto name_size = static_cast<std::uint32_t>(name.size());
  const auto data_size = static_cast<std::uint32_t>(size);
  raw(&name_size, sizeof(name_size));
  raw(name.data(), name.size());
  raw(&data_size, sizeof(data_size));
  raw(data, size);
}

void StateReader::raw(std::string_view name, void* data, std::size_t size) {
  if (bytes_.size() - position_ < size) fail(name, "the data end too soon");
  std::memcpy(data, bytes_.data() + position_, size);
  position_ += size;
}

void StateReader::block(std::string_view name, void* data, std::size_t size) {
  std::uint32_t name_size = 0;
  raw(name, &name_size, sizeof(name_size));
  if (bytes_.size() - position_ < name_size) fail(name, "the data end too soon");
  const std::string_view found = bytes_.substr(position_, name_size);
  if (found != name) fail(name, fmt::format("found '{}' in its place", found));
  position_ += name_size;
  std::uint32_t data_size = 0;
  raw(name, &data_size, sizeof(data_size));
  if (data_size != size) fail(name, fmt::format("{} bytes, expected {}", data_size, size));
  raw(name, data, size);
}

void StateReader::value(std::string_view name, bool& value) {
  std::uint8_t byte = 0;
  block(name, &byte, sizeof(byte));
  if (byte > 1) fail(name, fmt::format("{}, expected 0 or 1", byte));
  value = byte == 1;
}

void StateReader::version(std::string_view name, std::int32_t wanted) {
  std::int32_t found = 0;
  value(name, found);
  if (found != wanted) fail(name, fmt::format("version {}, expected {}", found, wanted));
}

void StateReader::check_same(std::string_view name, const std::int32_t (&found)[3],
                             const std::int32_t (&wanted)[3]) {
  if (std::equal(std::begin(found), std::end(found), std::begin(wanted))) return;
  fail(name, fmt::format("{}x{}x{}, expected {}x{}x{}", found[0], found[1], found[2], wanted[0],
                         wanted[1], wanted[2]));
}

void StateReader::check_shape(std::string_view name, const std::int32_t (&shape)[3],
                              std::size_t size) const {
  const bool valid = shape[0] >= 1 && shape[0] <= kMaxSide && shape[1] >= 1 &&
                     shape[1] <= kMaxSide && shape[2] >= 1 && shape[2] <= 64;
  if (!valid) fail(name, "a shape that no image has");
  // Before allocating: a damaged size must not ask for more memory than the data could fill.
  const std::size_t bytes = static_cast<std::size_t>(shape[0]) *
                            static_cast<std::size_t>(shape[1]) *
                            static_cast<std::size_t>(shape[2]) * size;
  if (bytes_.size() - position_ < bytes) fail(name, "the data end too soon");
}

void StateReader::finish() const {
  if (position_ != bytes_.size()) {
    throw std::runtime_error(fmt::format("state: {} bytes too many", bytes_.size() - position_));
  }
}

}  // namespace eigenlight
