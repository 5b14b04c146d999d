// State that outlives a process: named values in one byte string. Files, versions and checksums are
// the business of sequences/files/checkpoint.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

/// Appends named values. StateReader has functions of the same names, so that one template can list
/// the values of both save() and load().
class StateWriter {
 public:
  template <typename T>
  void value(std::string_view name, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    block(name, &value, sizeof(T));
  }
  /// Visible pixels only, so that the bytes do not depend on padding. An empty plane is kept as
  /// such.
  template <typename T>
  void plane(std::string_view name, const Plane<T>& plane) {
    const std::int32_t shape[3] = {plane.width(), plane.height(), plane.channels()};
    block(name, shape, sizeof(shape));
    if (plane.empty()) return;
    const std::size_t row = row_bytes(plane);
    for (int y = 0; y < plane.height(); ++y) raw(plane.row(y), row);
  }
  template <std::size_t N>
  void planes(std::string_view name, const Planes<N>& planes) {
    for (const auto& p : planes) plane(name, p);
  }
  [[nodiscard]] const std::vector<char>& bytes() const { return bytes_; }

 private:
  template <typename T>
  static std::size_t row_bytes(const Plane<T>& plane) {
    return static_cast<std::size_t>(plane.width()) * static_cast<std::size_t>(plane.channels()) *
           sizeof(T);
  }
  void block(std::string_view name, const void* data, std::size_t size);
  void raw(const void* data, std::size_t size);

  std::vector<char> bytes_;
};

/// Reads values back in the order they were written. Throws std::runtime_error naming the value
/// when the bytes hold another one, another size or shape, no bool where one is meant, or end too
/// soon.
class StateReader {
 public:
  explicit StateReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  void value(std::string_view name, T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    block(name, &value, sizeof(T));
  }
  void value(std::string_view name, bool& value);
  /// A value that must be `wanted`.
  void version(std::string_view name, std::int32_t wanted);
  /// A plane that has a shape is given values of that shape only; an empty one takes any.
  template <typename T>
  void plane(std::string_view name, Plane<T>& plane) {
    std::int32_t shape[3] = {0, 0, 0};
    block(name, shape, sizeof(shape));
    if (!plane.empty()) check_same(name, shape, {plane.width(), plane.height(), plane.channels()});
    if (shape[0] == 0 && shape[1] == 0) {
      plane = {};
      return;
    }
    check_shape(name, shape, sizeof(T));
    ensure_extent(plane, {shape[0], shape[1]}, shape[2]);
    const std::size_t row = static_cast<std::size_t>(shape[0]) * static_cast<std::size_t>(shape[2]);
    for (int y = 0; y < shape[1]; ++y) raw(name, plane.row(y), row * sizeof(T));
  }
  template <std::size_t N>
  void planes(std::string_view name, Planes<N>& planes) {
    for (auto& p : planes) plane(name, p);
  }
  /// Throws std::runtime_error if bytes are left.
  void finish() const;

 private:
  void check_shape(std::string_view name, const std::int32_t (&shape)[3], std::size_t size) const;
  static void check_same(std::string_view name, const std::int32_t (&found)[3],
                         const std::int32_t (&wanted)[3]);
  void block(std::string_view name, void* data, std::size_t size);
  void raw(std::string_view name, void* data, std::size_t size);

  std::string_view bytes_;
  std::size_t position_ = 0;
};

}  // namespace eigenlight
