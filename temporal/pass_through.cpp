#include "temporal/pass_through.h"

#include <cmath>
#include <cstddef>

#include "frame/tiles.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::uint32_t kStateVersion = 1;

struct Counts {
  std::int64_t surface = 0, non_finite = 0;
};

}  // namespace

PassThrough::PassThrough(const DenoiserOptions& options)
    : output_(make_planes<3>(options.extent)), age_(options.extent) {}

const Planes<3>* PassThrough::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const Extent extent = age_.extent();
  EL_CHECK(frame_.extent() == extent, "frame {} is {}x{}, expected {}x{}", frame_.index,
           frame_.extent().width, frame_.extent().height, extent.width, extent.height);

  const TileGrid grid = stage_tiles(extent);
  std::vector<Counts> counts(static_cast<std::size_t>(grid.count()));
  for_each_tile(grid, [&](const Tile& tile) {
    Counts& count = counts[static_cast<std::size_t>(tile.index)];
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const bool surface = frame_.surface.id(x, y) != 0;
        const float r = frame_.indirect[0](x, y);
        const float g = frame_.indirect[1](x, y);
        const float b = frame_.indirect[2](x, y);
        const bool finite = std::isfinite(r) && std::isfinite(g) && std::isfinite(b);
        const bool used = surface && finite;
        output_[0](x, y) = used ? r : 0.0f;
        output_[1](x, y) = used ? g : 0.0f;
        output_[2](x, y) = used ? b : 0.0f;
        age_(x, y) = surface ? 1.0f : 0.0f;
        count.surface += surface ? 1 : 0;
        count.non_finite += surface && !finite ? 1 : 0;
      }
    }
  });
  for (const Counts& count : counts) {
    report_.surface_pixels += count.surface;
    report_.non_finite_pixels += count.non_finite;
  }
  report_.frame = frame_.index;
  report_.cut = true;
  report_.new_pixels = report_.surface_pixels;
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &output_;
}

void PassThrough::save(StateWriter& out) const { out.value("noisy", kStateVersion); }

void PassThrough::load(StateReader& in) {
  std::uint32_t version = 0;
  in.value("noisy", version);
  if (version != kStateVersion) {
    throw std::runtime_error(
        fmt::format("state of 'noisy': version {}, expected {}", version, kStateVersion));
  }
}

}  // namespace eigenlight
