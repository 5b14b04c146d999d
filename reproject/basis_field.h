// All bases of an image: what every temporal stage reads and writes.
#pragma once

#include <algorithm>

#include "frame/state.h"
#include "frame/tiles.h"

namespace eigenlight {

inline constexpr int kMaxBases = 8;

/// Pixels that lie side by side in a block of BasisField: a cache line, and the longest vector.
inline constexpr int kBlock = static_cast<int>(Plane<float>::kLine / sizeof(float));

/// K bases of an RGB image and the age of each pixel, in blocks of 16 pixels of a row:
///   [y][x / 16] { [channel][k] 16 floats, 16 ages }.
///
/// Vectors run along a line of a block, and a block is contiguous memory: stored as 3 K + 1 planes,
/// bases took a third longer. The age travels through the same taps as the
/// values it belongs to. All are 0 without history, and so are pixels behind the last one of a row,
/// because kernels process whole vectors: a kernel that writes there writes 0.
class BasisField {
 public:
  BasisField() = default;
  /// Throws std::invalid_argument unless `bases` is in [1, kMaxBases], or for a bad size.
  BasisField(Extent extent, int bases) : extent_(extent), bases_(bases) {
    check_bases(bases);
    check_extent(extent);
    data_ = Plane<float>({kBlock * blocks(), extent.height}, lines());
  }

  /// Makes room for another number of bases; what the pixels held is lost if it differs. Allocates
  /// only where there have never been as many. Throws std::invalid_argument unless it is in [1,
  /// kMaxBases].
  void reshape(int bases) {
    if (bases == bases_) return;
    check_bases(bases);
    bases_ = bases;
    data_.reshape(lines());
  }

  [[nodiscard]] int bases() const { return bases_; }
  [[nodiscard]] Extent extent() const { return extent_; }
  /// Lines of 16 floats in a block: 3 K, then the ages.
  [[nodiscard]] int lines() const { return 3 * bases_ + 1; }
  [[nodiscard]] int line_of(int c, int k) const { return c * bases_ + k; }
  /// Where pixel (x, y) lies in line 0 of its block; its values in other lines follow kBlock floats
  /// apart.
  [[nodiscard]] float* at(int x, int y) { return data_.row(y) + offset(x); }
  [[nodiscard]] const float* at(int x, int y) const { return data_.row(y) + offset(x); }
  /// Where its age lies, and those of the pixels beside it in the block.
  [[nodiscard]] float* ages(int x, int y) { return at(x, y) + kBlock * 3 * bases_; }
  [[nodiscard]] const float* ages(int x, int y) const { return at(x, y) + kBlock * 3 * bases_; }

  [[nodiscard]] float& value(int x, int y, int c, int k) {
    return at(x, y)[kBlock * line_of(c, k)];
  }
  [[nodiscard]] float value(int x, int y, int c, int k) const {
    return at(x, y)[kBlock * line_of(c, k)];
  }
  [[nodiscard]] float& age(int x, int y) { return *ages(x, y); }
  [[nodiscard]] float age(int x, int y) const { return *ages(x, y); }

  void clear() { data_.fill(0.0f); }
  /// Forgets the pixels of a tile, whose sides are whole blocks or those of the image.
  void clear(const Rect& tile) {
    EL_DCHECK(tile.x0 % kBlock == 0 && (tile.x1 % kBlock == 0 || tile.x1 == extent_.width));
    const int blocks = (tile.x1 - tile.x0 + kBlock - 1) / kBlock;
    for (int y = tile.y0; y < tile.y1; ++y) {
      std::fill_n(at(tile.x0, y), blocks * kBlock * lines(), 0.0f);
    }
  }
  /// The ages of a row of a tile, in whole blocks.
  void copy_ages(const Rect& row, Plane<float>& to) const {
    EL_DCHECK(row.x0 % kBlock == 0);
    for (int x = row.x0; x < row.x1; x += kBlock) {
      std::copy_n(ages(x, row.y0), kBlock, to.at(x, row.y0));
    }
  }
  /// Takes the ages of another field of the same extent, and its bases: as many as both have.
  void assign(const BasisField& other);
  void clear_basis(int k);

  /// The number of bases is the caller's to save, and the same when they are read. load() throws
  /// std::runtime_error where StateReader does.
  void save(StateWriter& out) const { out.plane("bases", data_); }
  void load(StateReader& in) { in.plane("bases", data_); }

 private:
  static void check_bases(int bases) {
    EL_CHECK(bases >= 1 && bases <= kMaxBases, "bases {}: expected 1 to {}", bases, kMaxBases);
  }
  [[nodiscard]] int blocks() const { return (extent_.width + kBlock - 1) / kBlock; }
  [[nodiscard]] int offset(int x) const { return x / kBlock * kBlock * lines() + x % kBlock; }

  Extent extent_;
  int bases_ = 1;
  Plane<float> data_;
};

/// Asks for the block under pixel (x, y) in the next row, if there is one: see frame/prefetch.h.
inline void prefetch_below(const BasisField& field, int x, int y) {
  const auto [width, height] = field.extent();
  if (x < 0 || x >= width || y + 1 >= height) return;
  const float* below = field.at(x / kBlock * kBlock, y + 1);
  for (int line = 0; line < field.lines(); ++line) __builtin_prefetch(below + kBlock * line);
}

}  // namespace eigenlight
