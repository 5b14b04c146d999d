// A tile of a grid and those around it.
#pragma once

#include <algorithm>

#include "frame/tiles.h"

namespace eigenlight {

/// Calls body(index) for a tile and the up to eight around it, in row order.
template <typename Body>
void for_each_neighbor(const TileGrid& grid, int index, Body body) {
  const int column = index % grid.columns(), row = index / grid.columns();
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows() - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns() - 1); ++x) {
      body(y * grid.columns() + x);
    }
  }
}

}  // namespace eigenlight
