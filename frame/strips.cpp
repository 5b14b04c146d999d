#include "frame/strips.h"

#include <algorithm>

namespace eigenlight {
namespace {

// Per thread: a thread that is late then has little left that the others wait for.
constexpr int kShare = 8;

int tiles_of_strip(const TileGrid& grid) {
  const auto fit = [&](int width) { return std::max(width / grid.tile_width(), 1); };
  const auto strips = [&](int tiles) { return (grid.columns() + tiles - 1) / tiles * grid.rows(); };
  int tiles = std::min(fit(kStripWidth), grid.columns());
  while (tiles > fit(kNarrowStrip) && strips(tiles) < kShare * thread_count()) {
    tiles = std::max((tiles + 1) / 2, fit(kNarrowStrip));
  }
  return tiles;
}

}  // namespace

void for_each_strip(const TileGrid& grid, const std::function<void(const Strip&)>& body) {
  const int tiles = tiles_of_strip(grid);
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
