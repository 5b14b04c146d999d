#include "temporal/baselines/chen2012.h"

#include <algorithm>
#include <cmath>

#include "temporal/bases/tile_sums.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 2;

}  // namespace

Chen2012::Chen2012(const DenoiserOptions& options, const ChenOptions& parts)
    : options_(parts),
      history_(options.extent, options.bases),
      pca_(options.extent, options.bases),
      filter_(options.extent),
      counts_(static_cast<std::size_t>(stage_tiles(options.extent).count())),
      extra_(options.extent),
      smooth_(options.extent),
      extra_mean_(make_planes<3>(options.extent)),
      light_(make_planes<3>(options.extent)),
      output_(make_planes<3>(options.extent)),
      old_age_(options.extent),
      age_(options.extent),
      weight_(options.extent) {}

const Planes<3>* Chen2012::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_.frame = frame_.index;
  report_[Stage::kSource] = clock.lap();
  const BasisHistory::Warp warp = history_.warp(frame_);
  report_.cut = warp.cut;
  report_.skipped_warp = warp.skipped;
  number_ = warp.cut ? 1 : std::min(number_ + 1, static_cast<int>(kMostFrames));
  report_[Stage::kWarp] = clock.lap();
  resample(source);
  report_[Stage::kResample] = clock.lap();

  BasisField& bases = history_.bases();
  const PcaFrame pca_frame{light_, weight_, number_};
  for_each_tile(stage_tiles(age_.extent()), [&](const Tile& tile) { weigh(tile); });
  if (!warp.cut) pca_.orthogonalize(bases);
  pca_.update(pca_frame, bases);
  report_[Stage::kUpdate] = clock.lap();
  if (options_.basis_filter) filter_.process(frame_, smooth_, bases);
  report_[Stage::kFilter] = clock.lap();
  report_.mean_rank = pca_.reconstruct(pca_frame, bases, output_);
  history_.keep(frame_);
  report_[Stage::kProject] = clock.lap();
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &output_;
}

void Chen2012::resample(FrameSource& source) {
  const TileGrid tiles = stage_tiles(age_.extent());
  for_each_tile(tiles, [&](const Tile& tile) { find_new_pixels(tile); });
  for (const PixelCounts& counts : counts_) report_.new_pixels += counts.fresh;
  const bool wanted = !report_.cut && report_.new_pixels > 0;
  const bool resampled = wanted && eigenlight::resample(source, extra_, frame_, extra_mean_);
  if (resampled) report_.extra_samples = kExtraSamples * report_.new_pixels;
  for_each_tile(tiles, [&](const Tile& tile) { merge_samples(tile, resampled); });
  for (const PixelCounts& counts : counts_) {
    report_.surface_pixels += counts.surface;
    report_.non_finite_pixels += counts.non_finite;
  }
}

void Chen2012::find_new_pixels(const Tile& tile) {
  PixelCounts& counts = counts_[static_cast<std::size_t>(tile.index)];
  counts = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      old_age_(x, y) = history_.bases().age(x, y);
      const bool surface = frame_.surface.id(x, y) != 0;
      const bool fresh = surface && old_age_(x, y) == 0.0f;
      extra_(x, y) = static_cast<std::uint8_t>(fresh ? kExtraSamples : 0);
      counts.surface += surface ? 1 : 0;
      counts.fresh += fresh ? 1 : 0;
    }
  }
}

// u: the mean of all samples of each pixel. age_ says where it can be used: 1, else 0.
void Chen2012::merge_samples(const Tile& tile, bool resampled) {
  PixelCounts& counts = counts_[static_cast<std::size_t>(tile.index)];
  const float regular = static_cast<float>(std::max(frame_.spp, 1));
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool surface = frame_.surface.id(x, y) != 0;
      const float extra = resampled ? static_cast<float>(extra_(x, y)) : 0.0f;
      float sum = 0.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        float& u = light_[c](x, y);
        u = frame_.lights[0].radiance[c](x, y);
        if (extra > 0.0f) u = (regular * u + extra * extra_mean_[c](x, y)) / (regular + extra);
        sum += std::abs(u);
      }
      // Bases must hold products of two lights. The comparison is false for NaN.
      const bool finite = std::islessequal(sum, kLargestLight);
      age_(x, y) = surface && finite ? 1.0f : 0.0f;
      counts.non_finite += surface && !finite ? 1 : 0;
    }
  }
}

// Ages with this frame, the weights that follow, and where bases are to be smoothed.
void Chen2012::weigh(const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool usable = age_(x, y) > 0.0f;
      const bool fresh = extra_(x, y) > 0;
      const float age = usable ? std::min(old_age_(x, y) + 1.0f, kMostFrames) : old_age_(x, y);
      const float n = options_.per_pixel_weights ? age : static_cast<float>(number_);
      weight_(x, y) = usable ? std::min(1.0f, (1.0f + kAmnesia) / n) : 0.0f;
      smooth_(x, y) = fresh && !(report_.cut && usable) ? 1 : 0;
      age_(x, y) = history_.bases().age(x, y) = age;
    }
  }
}

void Chen2012::save(StateWriter& out) const {
  out.value("chen2012", kStateVersion);
  out.value("number", number_);
  history_.save(out);
}

void Chen2012::load(StateReader& in) {
  in.version("chen2012", kStateVersion);
  in.value("number", number_);
  number_ = std::clamp(number_, 0, static_cast<int>(kMostFrames));
  history_.load(in);
}

}  // namespace eigenlight
