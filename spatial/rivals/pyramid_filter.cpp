#include "spatial/rivals/pyramid_filter.h"

#include <algorithm>

namespace eigenlight {
namespace {

TileGrid up_tiles(Extent extent) { return {extent, kPyramidTileWidth, kPyramidTileHeight}; }
TileGrid down_tiles(Extent extent) {
  return {extent, kPyramidTileWidth / 2, kPyramidTileHeight / 2};
}

}  // namespace

PyramidFilter::PyramidFilter(Extent extent, const GlobalIlluminationEdge& edge,
                             const PyramidTable& table)
    : extent_(extent), edge_(edge), weights_(table.weights(edge.blur_radius)) {
  check_extent(extent);
  edge.validate();
  for (PyramidPass& pass : weights_) pass.gamma *= edge.gamma();
  for (std::size_t l = 0; l < weights_.size(); ++l) {
    extent = {(extent.width + 1) / 2, (extent.height + 1) / 2};
    levels_.emplace_back(extent);
  }
}

void PyramidFilter::process(const SpatialInputs& in, Planes<3>& out) {
  const auto fits = [&](const Plane<float>& plane) { return plane.extent() == extent_; };
  EL_CHECK(in.guides.extent() == extent_ && fits(in.weight) &&
               std::all_of(in.signal.begin(), in.signal.end(), fits) &&
               std::all_of(out.begin(), out.end(), fits),
           "pyramid filter made for {}x{}: got planes of another size", extent_.width,
           extent_.height);
  EL_CHECK(&in.signal != &out, "pyramid filter: the output must not be the signal itself");
  const PyramidImage image{in.guides.surface, in.signal, in.weight};
  const auto view = [&](std::size_t l) {
    return PyramidView{image, l == 0 ? nullptr : &levels_[l - 1]};
  };
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    for_each_tile(down_tiles(levels_[l].depth.extent()),
                  [&](const Rect& tile) { pyramid_down_tile(view(l), edge_, tile, levels_[l]); });
  }
  copy_planes(levels_.back().values, levels_.back().result);
  for (std::size_t l = levels_.size(); l-- > 1;) {
    const PyramidUpPass up{view(l), levels_[l], edge_, weights_[l]};
    for_each_tile(up_tiles(view(l).extent()),
                  [&](const Rect& tile) { pyramid_up_tile(up, tile, levels_[l - 1].result); });
  }
  const PyramidUpPass last{view(0), levels_[0], edge_, weights_[0]};
  for_each_tile(up_tiles(extent_), [&](const Rect& tile) { pyramid_last_tile(last, tile, out); });
}

}  // namespace eigenlight
