#include "temporal/baselines/blended_history.h"

#include <utility>

#include "temporal/stage_clock.h"

namespace eigenlight {

BlendedHistory::BlendedHistory(Extent extent, HistorySetup setup)
    : setup_(std::move(setup)),
      tiles_(stage_tiles(extent)),
      history_(extent, setup_.bases, setup_.history),
      age_(extent),
      counts_(static_cast<std::size_t>(tiles_.count())) {}

const Planes<3>* BlendedHistory::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const BasisHistory::Warp warp = history_.warp(frame_);
  report_[Stage::kWarp] = clock.lap();
  for_each_tile(tiles_, [&](const Tile& tile) { blend_tile(tile); });
  report_[Stage::kUpdate] = clock.lap();
  const Planes<3>& picture = finish();
  history_.keep(frame_);
  report_[Stage::kFilter] = clock.lap();

  report_.frame = frame_.index;
  report_.cut = warp.cut;
  report_.skipped_warp = warp.skipped;
  for (const PixelCounts& counts : counts_) counts.add_to(report_);
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &picture;
}

void BlendedHistory::save(StateWriter& out) const {
  out.value(setup_.name, setup_.version);
  history_.save(out);
}

void BlendedHistory::load(StateReader& in) {
  in.version(setup_.name, setup_.version);
  history_.load(in);
}

}  // namespace eigenlight
