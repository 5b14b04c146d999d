#include "temporal/baselines/basis_history.h"

#include <utility>

#include "reproject/warp.h"

namespace eigenlight {

BasisHistory::BasisHistory(Extent extent, int bases)
    : surfaces_(extent), bases_(extent, bases), warped_(extent, bases) {}

BasisHistory::Warp BasisHistory::warp(const Frame& frame) {
  EL_CHECK(frame.extent() == extent(), "frame {} is {}x{}, expected {}x{}", frame.index,
           frame.extent().width, frame.extent().height, extent().width, extent().height);
  if (!surfaces_.is_followed_by(frame)) {
    bases_.data().fill(0.0f);
    return {.cut = true};
  }
  if (frame.is_static) return {.skipped = static_cast<std::int64_t>(extent().pixels())};
  const PreviousSurface previous = surfaces_.previous();
  for_each_tile(stage_tiles(extent()), [&](const Tile& tile) {
    TapSegment taps;
    for (int y = tile.y0; y < tile.y1; ++y) {
      const Tile row{tile.x0, y, tile.x1, y + 1, tile.index};
      compute_taps(frame, previous, taps_, row, taps);
      warp_bases(bases_, taps, row, warped_);
    }
  });
  std::swap(bases_, warped_);
  return {};
}

void BasisHistory::save(StateWriter& out) const {
  surfaces_.save(out);
  out.value("bases", bases_.bases());
  out.plane("basis values", bases_.data());
}

void BasisHistory::load(StateReader& in) {
  const Extent wanted = extent();
  surfaces_.load(in);
  int bases = 0;
  in.value("bases", bases);
  if (bases != bases_.bases()) {
    throw std::runtime_error(fmt::format("state: {} bases, expected {}", bases, bases_.bases()));
  }
  in.plane("basis values", bases_.data());
  if (extent() != wanted) {
    throw std::runtime_error(fmt::format("state: {}x{}, expected {}x{}", extent().width,
                                         extent().height, wanted.width, wanted.height));
  }
}

}  // namespace eigenlight
