#include "temporal/baselines/running_mean.h"

#include <algorithm>
#include <cmath>

#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::uint32_t kStateVersion = 2;

}  // namespace

RunningMean::RunningMean(const DenoiserOptions& options)
    : history_(options.extent, 1),
      output_(make_planes<3>(options.extent)),
      age_(options.extent),
      counts_(static_cast<std::size_t>(stage_tiles(options.extent).count())) {}

const Planes<3>* RunningMean::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const BasisHistory::Warp warp = history_.warp(frame_);
  report_[Stage::kReproject] = clock.lap();
  for_each_tile(stage_tiles(age_.extent()), [&](const Tile& tile) {
    update(tile, counts_[static_cast<std::size_t>(tile.index)]);
  });
  history_.keep(frame_);
  report_[Stage::kUpdate] = clock.lap();

  report_.frame = frame_.index;
  report_.cut = warp.cut;
  report_.skipped_warp = warp.skipped;
  for (const Counts& counts : counts_) {
    report_.surface_pixels += counts.surface;
    report_.new_pixels += counts.fresh;
    report_.non_finite_pixels += counts.non_finite;
  }
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &output_;
}

void RunningMean::update(const Tile& tile, Counts& counts) {
  BasisField& sums = history_.bases();
  counts = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool surface = frame_.surface.id(x, y) != 0;
      const auto& u = frame_.indirect;
      const bool finite =
          std::isfinite(u[0](x, y)) && std::isfinite(u[1](x, y)) && std::isfinite(u[2](x, y));
      float& age = sums.age(x, y);
      counts.surface += surface ? 1 : 0;
      counts.fresh += surface && age == 0.0f ? 1 : 0;
      counts.non_finite += surface && !finite ? 1 : 0;
      const float known = age;
      if (surface && finite) age = std::min(known + 1.0f, kMostFrames);
      for (std::size_t c = 0; c < 3; ++c) {
        float& sum = sums.value(x, y, static_cast<int>(c), 0);
        float mean = known > 0.0f ? sum / known : 0.0f;
        if (surface && finite) mean += (u[c](x, y) - mean) / age;
        sum = mean * age;
        output_[c](x, y) = mean;
      }
      age_(x, y) = age;
    }
  }
}

void RunningMean::save(StateWriter& out) const {
  out.value("mean", kStateVersion);
  history_.save(out);
}

void RunningMean::load(StateReader& in) {
  std::uint32_t version = 0;
  in.value("mean", version);
  if (version != kStateVersion) {
    throw std::runtime_error(
        fmt::format("state of 'mean': version {}, expected {}", version, kStateVersion));
  }
  history_.load(in);
}

}  // namespace eigenlight
