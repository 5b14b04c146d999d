#include "frame/strips.h"

#include <algorithm>

namespace eigenlight {

void for_each_strip(const TileGrid& grid, const std::function<void(const Strip&)>& body) {
  const int tiles = std::max(kStripWidth / grid.tile_width(), 1);
  const int per_row = (grid.columns() + tiles - 1) / tiles;
  parallel_for(per_row * grid.rows(), [&](int i) {
    const int column = i % per_row * tiles;
    const int count = std::min(tiles, grid.columns() - column);
    Strip strip{grid.tile(i / per_row * grid.columns() + column), count};
    strip.area.x1 = grid.tile(strip.area.index + count - 1).x1;
    body(strip);
  });
}

}  // namespace eigenlight
