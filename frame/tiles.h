// The fixed tile grid and the one parallel loop. tiles.cpp is the only file that includes TBB.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

/// Pixels [x0, x1) x [y0, y1) of an image.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] int pixels() const { return width() * height(); }
};

/// A tile of a grid, or the part of one that a loop is at.
struct Tile : Rect {
  int index = 0;  ///< in row order over the grid
};

template <typename T>
void fill_rect(Plane<T>& plane, const Rect& area, T value) {
  for (int y = area.y0; y < area.y1; ++y) {
    std::fill(plane.at(area.x0, y), plane.at(area.x1 - 1, y) + plane.channels(), value);
  }
}

/// A grid that depends on the extent and the tile size alone, never on the number of threads: sums
/// kept per tile and added in index order have the same bits however many threads there are.
class TileGrid {
 public:
  /// Throws std::invalid_argument on an empty extent or a tile side below 1.
  TileGrid(Extent extent, int tile_width, int tile_height);

  [[nodiscard]] Extent extent() const { return extent_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int count() const { return columns_ * rows_; }
  [[nodiscard]] int tile_width() const { return tile_width_; }
  [[nodiscard]] int tile_height() const { return tile_height_; }
  [[nodiscard]] Tile tile(int index) const;

 private:
  Extent extent_;
  int tile_width_, tile_height_;
  int columns_, rows_;
};

/// One value for each tile of a grid, by the tile or its index.
template <typename T>
class PerTile {
 public:
  PerTile() = default;
  explicit PerTile(const TileGrid& grid, const T& value = T{})
      : values_(static_cast<std::size_t>(grid.count()), value) {}

  [[nodiscard]] T& operator[](int tile) { return values_[static_cast<std::size_t>(tile)]; }
  [[nodiscard]] const T& operator[](int tile) const {
    return values_[static_cast<std::size_t>(tile)];
  }
  [[nodiscard]] T& operator[](const Tile& tile) { return (*this)[tile.index]; }
  [[nodiscard]] const T& operator[](const Tile& tile) const { return (*this)[tile.index]; }

  void fill(const T& value) { std::fill(values_.begin(), values_.end(), value); }
  [[nodiscard]] int size() const { return static_cast<int>(values_.size()); }
  [[nodiscard]] std::span<const T> values() const { return values_; }
  [[nodiscard]] auto begin() { return values_.begin(); }
  [[nodiscard]] auto end() { return values_.end(); }
  [[nodiscard]] auto begin() const { return values_.begin(); }
  [[nodiscard]] auto end() const { return values_.end(); }

 private:
  std::vector<T> values_;
};

/// Tiles for stages that have no tile size of their own: 64 pixels are whole cache lines of every
/// type, 16 rows keep a tile of five RGB bases (60 kB) within the second-level cache.
[[nodiscard]] inline TileGrid stage_tiles(Extent extent) { return {extent, 64, 16}; }

/// Calls body(i) once for each i in [0, count), in any order and on any thread. An exception thrown
/// by the body is rethrown here.
void parallel_for(int count, const std::function<void(int)>& body);

/// Calls body(tile) once for each tile of the grid, in any order and on any thread.
void for_each_tile(const TileGrid& grid, const std::function<void(const Tile&)>& body);

/// Threads that the loops above use, at least 1. 0 asks for one per core. Not to be called while a
/// loop runs.
void set_thread_count(int threads);
[[nodiscard]] int thread_count();

/// Makes the loops above visit their indices in another order, for tests that it does not matter:
/// 0 is the plain order, every other number another one. Not to be called while a loop runs.
void set_loop_order(std::uint32_t order);

}  // namespace eigenlight
