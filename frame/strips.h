// A tile grid walked as memory lies: along rows that are long enough for hardware to foresee.
#pragma once

#include "frame/tiles.h"

namespace eigenlight {

/// Widest strip in pixels: sixteen cache lines of a row of floats, while 32 rows of sixteen planes
/// (512 kB) still fit the second-level cache. temporal/README.md tells what that is worth.
inline constexpr int kStripWidth = 256;

/// Neighboring tiles of one row of a grid, as many as fit kStripWidth and at least one.
struct Strip {
  Tile area;      ///< all of their pixels; the index is that of the leftmost tile
  int tiles = 1;  ///< how many
};

/// Calls body(strip) once for each strip of the grid, in any order and on any thread.
void for_each_strip(const TileGrid& grid, const std::function<void(const Strip&)>& body);

/// Calls body(segment) for each row of pixels of each tile of a strip, as a tile one row high with
/// the index of its tile: line by line, each from left to right. The rows of one tile come in
/// order. For work that needs nothing of the rows around it.
template <typename Body>
void for_each_segment(const TileGrid& grid, const Strip& strip, Body&& body) {
  for (int y = strip.area.y0; y < strip.area.y1; ++y) {
    for (int i = strip.area.index; i < strip.area.index + strip.tiles; ++i) {
      const Tile tile = grid.tile(i);
      body(Tile{tile.x0, y, tile.x1, y + 1, i});
    }
  }
}

/// Both of the above.
template <typename Body>
void for_each_segment(const TileGrid& grid, Body&& body) {
  for_each_strip(grid, [&](const Strip& strip) { for_each_segment(grid, strip, body); });
}

}  // namespace eigenlight
