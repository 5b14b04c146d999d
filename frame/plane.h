// One image channel in memory: owned, movable, rows on 64-byte lines; or a view of a caller's
// memory.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "frame/check.h"
#include "frame/extent.h"

namespace eigenlight {

namespace detail {

inline constexpr std::size_t kLine = 64;  // bytes

// A first-level cache places a line by its address modulo 4 kB and keeps some 8 lines per place. If
// rows and planes lay multiples of 4 kB apart, a kernel that reads more than 8 of them would
// evict its own lines.
inline constexpr std::size_t kAlias = 4096;

/// Lines from row to row. Long rows have an odd number: that costs less than 1 line in 16.
[[nodiscard]] constexpr std::size_t apart(std::size_t lines) {
  return lines < 16 ? lines : lines | 1;
}

/// Lines that may be read before the first value and after the last one: a vector may start up to
/// its own length beside a row, and its neighbor one pixel further.
inline constexpr std::size_t kMargin = 2;

/// Lines before the first one of a large plane. The number differs from plane to plane.
[[nodiscard]] inline std::size_t next_start() {
  static std::atomic<unsigned> made = 0;
  return made.fetch_add(5, std::memory_order_relaxed) % (kAlias / kLine);
}

}  // namespace detail

/// A 2-D array of trivially copyable values, zero-initialised.
///
/// Rows start on 64-byte lines and are padded to whole lines (odd numbers of them when long), so
/// that vector kernels may read (and, in rows they own, write) up to the padded width without a
/// tail loop; padding is never read as data. Up to a line before each row and two behind it may be
/// read as well: they hold padding, another row or zeros. Moves are cheap, copies are explicit:
/// clone() allocates, copy_from() does not.
///
/// view() makes a plane of memory that a caller owns. It is read-only, its rows need no alignment
/// beyond that of T, and its first and last rows are copied, because the memory beside them may not
/// be read; nothing else is.
template <typename T>
class Plane {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  static constexpr std::size_t kLine =
      detail::kLine;  ///< bytes: one cache line, one AVX-512 vector

  Plane() = default;
  /// `channels` values stand side by side at each pixel. Throws std::invalid_argument on a bad
  /// size.
  explicit Plane(Extent extent, int channels = 1) : extent_(extent), channels_(channels) {
    check_extent(extent);
    check_channels(channels);
    stride_ = stride_of(channels);
    capacity_ = stride_ * static_cast<std::size_t>(extent.height);
    const std::size_t bytes = capacity_ * sizeof(T), margin = detail::kMargin * kLine;
    Free free{margin, kLine};
    if (bytes >= detail::kAlias) free = {margin + detail::next_start() * kLine, detail::kAlias};
    auto* memory = static_cast<std::byte*>(
        ::operator new (free.start + bytes + margin, std::align_val_t{free.alignment}));
    data_ = {reinterpret_cast<T*>(memory + free.start), free};
    std::memset(memory + free.start - margin, 0, margin + bytes + margin);
    rows_ = std::make_unique<const T*[]>(static_cast<std::size_t>(extent.height));
    find_rows();
  }

  /// A view of `extent` values whose rows start `row_bytes` apart; negative for images from the
  /// bottom up. `first` is the row y = 0. The memory must outlive the view and stay as it is. Rows
  /// shorter than a few cache lines are copied: all of them lie too close to the end. Throws
  /// std::invalid_argument on a bad size, null, a stride shorter than a row, or one that is no
  /// multiple of the size of T.
  [[nodiscard]] static Plane view(const T* first, Extent extent, std::ptrdiff_t row_bytes);
  [[nodiscard]] bool is_view() const { return is_view_; }

  [[nodiscard]] Extent extent() const { return extent_; }
  [[nodiscard]] int width() const { return extent_.width; }
  [[nodiscard]] int height() const { return extent_.height; }
  [[nodiscard]] int channels() const { return channels_; }
  [[nodiscard]] bool empty() const { return !data_; }
  /// Values from the start of one row to the start of the next. Not of a view.
  [[nodiscard]] std::size_t stride() const { return stride_; }

  /// Not of a view, here and in all that changes values.
  [[nodiscard]] T* row(int y) {
    EL_DCHECK(y >= 0 && y < extent_.height && !is_view());
    return data_.get() + stride_ * static_cast<std::size_t>(y);
  }
  [[nodiscard]] const T* row(int y) const {
    EL_DCHECK(y >= 0 && y < extent_.height);
    return rows_[static_cast<std::size_t>(y)];
  }
  /// First value of pixel (x, y).
  [[nodiscard]] T* at(int x, int y) { return row(y) + x * channels_; }
  [[nodiscard]] const T* at(int x, int y) const { return row(y) + x * channels_; }
  [[nodiscard]] T& operator()(int x, int y) { return *at(x, y); }
  [[nodiscard]] const T& operator()(int x, int y) const { return *at(x, y); }

  /// Another number of values at each pixel, all 0. Allocates only where more room is needed than
  /// there ever was. Throws std::invalid_argument on a bad number.
  void reshape(int channels) {
    check_channels(channels);
    const std::size_t stride = stride_of(channels);
    if (empty() || is_view() || stride * static_cast<std::size_t>(extent_.height) > capacity_) {
      *this = Plane(extent_, channels);
      return;
    }
    channels_ = channels;
    stride_ = stride;
    find_rows();
    fill(T{});
  }

  /// The whole storage, padding included.
  [[nodiscard]] std::span<T> storage() {
    EL_DCHECK(!is_view());
    return {data_.get(), storage_size()};
  }
  [[nodiscard]] std::span<const T> storage() const {
    EL_DCHECK(!is_view());
    return {data_.get(), storage_size()};
  }

  void fill(T value) {
    EL_DCHECK(!is_view());
    std::fill_n(data_.get(), storage_size(), value);
  }
  /// A copy that owns its values, of a view as well.
  [[nodiscard]] Plane clone() const {
    Plane copy;
    if (!empty()) {
      copy = Plane(extent_, channels_);
      copy.copy_from(*this);
    }
    return copy;
  }
  /// Copies the values of a plane of the same shape. Throws std::invalid_argument on another shape.
  void copy_from(const Plane& other) {
    EL_CHECK(extent_ == other.extent_ && channels_ == other.channels_,
             "planes differ in shape: {}x{}x{} and {}x{}x{}", extent_.width, extent_.height,
             channels_, other.extent_.width, other.extent_.height, other.channels_);
    EL_DCHECK(!is_view());
    if (other.is_view()) {
      const std::size_t values = static_cast<std::size_t>(extent_.width * channels_);
      for (int y = 0; y < extent_.height; ++y) std::copy_n(other.row(y), values, row(y));
    } else if (!empty()) {
      std::memcpy(static_cast<void*>(data_.get()), other.data_.get(), storage_size() * sizeof(T));
    }
  }

 private:
  struct Free {
    std::size_t start = 0;  // bytes before the first value
    std::size_t alignment = kLine;
    void operator()(T* p) const {
      ::operator delete (reinterpret_cast<std::byte*>(p) - start, std::align_val_t{alignment});
    }
  };

  static void check_channels(int channels) {
    EL_CHECK(channels >= 1 && channels <= 64, "a pixel holds 1 to 64 values, not {}", channels);
  }
  [[nodiscard]] std::size_t stride_of(int channels) const {
    const std::size_t row =
        static_cast<std::size_t>(extent_.width) * static_cast<std::size_t>(channels) * sizeof(T);
    return detail::apart((row + kLine - 1) / kLine) * kLine / sizeof(T);
  }
  void find_rows() {
    for (int y = 0; y < extent_.height; ++y) {
      rows_[static_cast<std::size_t>(y)] = data_.get() + stride_ * static_cast<std::size_t>(y);
    }
  }
  [[nodiscard]] std::size_t storage_size() const {
    return empty() ? 0 : stride_ * static_cast<std::size_t>(extent_.height);
  }

  Extent extent_;
  int channels_ = 1;
  std::size_t stride_ = 0, capacity_ = 0;  // values
  std::unique_ptr<T[], Free> data_;
  // Where constant rows start: those of a view lie in two blocks of memory. row() must stay a
  // single load, or kernels are not inlined.
  std::unique_ptr<const T*[]> rows_;
  bool is_view_ = false;
};

template <typename T>
Plane<T> Plane<T>::view(const T* first, Extent extent, std::ptrdiff_t row_bytes) {
  check_extent(extent);
  constexpr auto kSize = static_cast<std::ptrdiff_t>(sizeof(T));
  const std::ptrdiff_t apart = row_bytes < 0 ? -row_bytes : row_bytes;
  EL_CHECK(first != nullptr, "a view of {}x{} values of null", extent.width, extent.height);
  EL_CHECK(apart >= extent.width * kSize, "rows {} bytes apart: a row of {} values has {} bytes",
           row_bytes, extent.width, extent.width * kSize);
  EL_CHECK(row_bytes % kSize == 0, "rows {} bytes apart: expected a multiple of {}", row_bytes,
           kSize);
  const std::ptrdiff_t stride = row_bytes / kSize;
  const auto copy_row = [&](int from, int to, Plane& out) {
    std::copy_n(first + stride * from, extent.width, out.row(to));
  };
  // Kernels may read the padding of a row and the margin behind it.
  if (apart < static_cast<std::ptrdiff_t>((detail::kMargin + 1) * kLine)) {
    Plane copy(extent);
    for (int y = 0; y < extent.height; ++y) copy_row(y, y, copy);
    return copy;
  }
  Plane view({extent.width, 2});
  copy_row(0, 0, view);
  copy_row(extent.height - 1, 1, view);
  auto rows = std::make_unique<const T*[]>(static_cast<std::size_t>(extent.height));
  for (int y = 0; y < extent.height; ++y) rows[static_cast<std::size_t>(y)] = first + stride * y;
  rows[static_cast<std::size_t>(extent.height - 1)] = view.row(1);
  rows[0] = view.row(0);
  view.extent_ = extent;
  view.rows_ = std::move(rows);
  view.is_view_ = true;
  return view;
}

/// N planes of floats, one per channel (red, green, blue or x, y, z).
template <std::size_t N>
struct Planes : std::array<Plane<float>, N> {
  template <std::integral Index>
  [[nodiscard]] Plane<float>& operator[](Index c) {
    return std::array<Plane<float>, N>::operator[](static_cast<std::size_t>(c));
  }
  template <std::integral Index>
  [[nodiscard]] const Plane<float>& operator[](Index c) const {
    return std::array<Plane<float>, N>::operator[](static_cast<std::size_t>(c));
  }
};

template <std::size_t N>
[[nodiscard]] Planes<N> make_planes(Extent extent) {
  Planes<N> planes;
  for (auto& plane : planes) plane = Plane<float>(extent);
  return planes;
}

/// Gives `plane` the shape `extent`, keeping its storage (and values) when it already owns that
/// much of it; a view becomes a plane of its own.
template <typename T>
void ensure_extent(Plane<T>& plane, Extent extent, int channels = 1) {
  if (plane.empty() || plane.is_view() || plane.extent() != extent ||
      plane.channels() != channels) {
    plane = Plane<T>(extent, channels);
  }
}

template <std::size_t N>
void ensure_extent(Planes<N>& planes, Extent extent) {
  for (auto& plane : planes) ensure_extent(plane, extent);
}

template <std::size_t N>
void copy_planes(const Planes<N>& from, Planes<N>& to) {
  for (std::size_t c = 0; c < N; ++c) to[c].copy_from(from[c]);
}

}  // namespace eigenlight
