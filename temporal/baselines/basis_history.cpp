#include "temporal/baselines/basis_history.h"

#include <utility>

#include "reproject/warp.h"

namespace eigenlight {

BasisHistory::BasisHistory(Extent extent, int bases)
    : bases_(extent, bases), warped_(extent, bases) {
  surface_.resize(extent);
}

BasisHistory::Warp BasisHistory::warp(const Frame& frame) {
  EL_CHECK(frame.extent() == extent(), "frame {} is {}x{}, expected {}x{}", frame.index,
           frame.extent().width, frame.extent().height, extent().width, extent().height);
  if (!known_ || index_ != frame.previous_index) {
    bases_.data().fill(0.0f);
    return {.cut = true};
  }
  if (frame.is_static) return {.skipped = static_cast<std::int64_t>(extent().pixels())};
  const PreviousSurface previous{camera_, surface_};
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

void BasisHistory::keep(const Frame& frame) {
  known_ = true;
  index_ = frame.index;
  camera_ = frame.camera;
  surface_.depth.copy_from(frame.surface.depth);
  copy_planes(frame.surface.normal, surface_.normal);
  surface_.id.copy_from(frame.surface.id);
}

void BasisHistory::save(StateWriter& out) const {
  out.value("known", known_);
  out.value("index", index_);
  out.value("camera", camera_);
  out.plane("depth", surface_.depth);
  out.planes("normal", surface_.normal);
  out.plane("id", surface_.id);
  out.value("bases", bases_.bases());
  out.plane("basis values", bases_.data());
}

void BasisHistory::load(StateReader& in) {
  const Extent wanted = extent();
  in.value("known", known_);
  in.value("index", index_);
  in.value("camera", camera_);
  in.plane("depth", surface_.depth);
  in.planes("normal", surface_.normal);
  in.plane("id", surface_.id);
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
