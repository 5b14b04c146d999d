#include "temporal/baselines/frame_by_frame.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "frame/tiles.h"
#include "temporal/samples/pixel_counts.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 1;

}  // namespace

FrameByFrame::FrameByFrame(const DenoiserOptions& options, std::string_view name,
                           std::unique_ptr<SpatialFilter> filter)
    : name_(name),
      filter_(std::move(filter)),
      signal_(make_planes<3>(options.extent)),
      weight_(options.extent),
      age_(options.extent) {
  if (filter_) filtered_ = make_planes<3>(options.extent);
}

const Planes<3>* FrameByFrame::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const Extent extent = age_.extent();
  EL_CHECK(frame_.extent() == extent, "frame {} is {}x{}, expected {}x{}", frame_.index,
           frame_.extent().width, frame_.extent().height, extent.width, extent.height);
  take_signal();
  if (filter_) filter_->process({frame_, signal_, weight_}, filtered_);
  report_[Stage::kFilter] = clock.lap();
  report_.frame = frame_.index;
  report_.cut = true;
  report_.new_pixels = report_.surface_pixels;
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return filter_ ? &filtered_ : &signal_;
}

void FrameByFrame::take_signal() {
  const TileGrid grid = stage_tiles(age_.extent());
  std::vector<PixelCounts> counts(static_cast<std::size_t>(grid.count()));
  for_each_tile(grid, [&](const Tile& tile) {
    PixelCounts& count = counts[static_cast<std::size_t>(tile.index)];
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const bool used = count.add(frame_, x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          signal_[c](x, y) = used ? frame_.lights[0].radiance[c](x, y) : 0.0f;
        }
        weight_(x, y) = used ? 1.0f : 0.0f;
        age_(x, y) = frame_.surface.id(x, y) != 0 ? 1.0f : 0.0f;
      }
    }
  });
  for (const PixelCounts& count : counts) count.add_to(report_);
}

void FrameByFrame::save(StateWriter& out) const { out.value(name_, kStateVersion); }

void FrameByFrame::load(StateReader& in) { in.version(name_, kStateVersion); }

}  // namespace eigenlight
