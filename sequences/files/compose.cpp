#include "sequences/files/compose.h"

#include "frame/tiles.h"

namespace eigenlight {

void modulate(const Planes<3>& albedo, const Planes<3>& light, Planes<3>& out) {
  const Extent extent = albedo[0].extent();
  EL_CHECK(light[0].extent() == extent, "light and albedo differ in size");
  ensure_extent(out, extent);
  for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        const float* a = albedo[c].row(y);
        const float* l = light[c].row(y);
        float* o = out[c].row(y);
        for (int x = tile.x0; x < tile.x1; ++x) o[x] = a[x] * l[x];
      }
    }
  });
}

void compose(const Frame& frame, const Planes<3>& indirect, const Planes<3>& direct,
             Planes<3>& out) {
  const Extent extent = frame.extent();
  EL_CHECK(indirect[0].extent() == extent && direct[0].extent() == extent,
           "light and frame differ in size");
  ensure_extent(out, extent);
  for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        const float* a = frame.surface.albedo[c].row(y);
        const float* d = direct[c].row(y);
        const float* i = indirect[c].row(y);
        const float* e = frame.emission[c].row(y);
        float* o = out[c].row(y);
        for (int x = tile.x0; x < tile.x1; ++x) o[x] = a[x] * (d[x] + i[x]) + e[x];
      }
    }
  });
}

}  // namespace eigenlight
