// Walks a tile grid in the order of memory, along rows long enough for hardware prefetching.
#pragma once

#include "frame/tiles.h"

namespace eigenlight {

/// Widest strip in pixels: long enough for hardware prefetching, while eight rows of twenty planes
/// (800 kB) still fit the second-level cache. docs/performance.md has measurements.
inline constexpr int kStripWidth = 1280;

/// Narrowest strip, taken for many threads: sixteen cache lines of a row of floats.
inline constexpr int kNarrowStrip = 256;

/// Neighboring tiles of one row of a grid, at least one.
struct Strip {
  Tile area;      ///< all of their pixels; the index is that of the leftmost tile
  int tiles = 1;  ///< how many
};

/// Calls body(strip) once for each strip of the grid, in any order and on any thread. Strips are as
/// wide as kStripWidth and the grid allow, or narrower, down to kNarrowStrip, until each thread has
/// eight: nothing that is computed may depend on their width.
void for_each_strip(const TileGrid& grid, const std::function<void(const Strip&)>& body);

/// Calls body(part) for the part of each tile that lies in a strip or band, from left to right.
template <typename Body>
void for_each_part(const TileGrid& grid, const Strip& band, Body&& body) {
  const Tile& area = band.area;
  for (int i = 0; i < band.tiles; ++i) {
    const int left = area.x0 + i * grid.tile_width();
    const int right = std::min(left + grid.tile_width(), area.x1);
    body(Tile{{left, area.y0, right, area.y1}, area.index + i});
  }
}

/// Calls body(band) for the rows of a strip, `rows` of them at a time, from the top down. For work
/// in several steps: each finds in the first-level cache what the step before has written.
template <typename Body>
void for_each_band(const Strip& strip, int rows, Body&& body) {
  for (int y = strip.area.y0; y < strip.area.y1; y += rows) {
    Strip band = strip;
    band.area.y0 = y;
    band.area.y1 = std::min(y + rows, strip.area.y1);
    body(band);
  }
}

/// Calls body(segment) for each row of pixels of each tile of a strip or band, as a tile one row
/// high with the index of its tile: line by line, each from left to right. The rows of one tile
/// come in order. For work that reads no other rows.
template <typename Body>
void for_each_segment(const TileGrid& grid, const Strip& strip, Body&& body) {
  for_each_band(strip, 1, [&](const Strip& row) { for_each_part(grid, row, body); });
}

/// for_each_strip and for_each_segment.
template <typename Body>
void for_each_segment(const TileGrid& grid, Body&& body) {
  for_each_strip(grid, [&](const Strip& strip) { for_each_segment(grid, strip, body); });
}

}  // namespace eigenlight
