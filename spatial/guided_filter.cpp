#include "spatial/guided_filter.h"

#include <algorithm>
#include <numeric>

#include "spatial/guided_filter_kernel.h"

namespace eigenlight {
namespace {

bool any_wanted(const Plane<std::uint8_t>& wanted, const Tile& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    const std::uint8_t* row = wanted.row(y);
    if (std::any_of(row + tile.x0, row + tile.x1, [](std::uint8_t w) { return w != 0; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

void GuidedOptions::validate() const {
  EL_CHECK(radius >= 1 && radius <= kGuidedRadius, "guided filter radius {}: expected 1 to {}",
           radius, kGuidedRadius);
  EL_CHECK(epsilon_normal >= 1e-4f && epsilon_normal <= 1.0f,
           "epsilon_normal {}: expected [1e-4, 1]", epsilon_normal);
  EL_CHECK(epsilon_depth >= 1e-4f && epsilon_depth <= 1.0f, "epsilon_depth {}: expected [1e-4, 1]",
           epsilon_depth);
}

GuidedFilter::GuidedFilter(Extent extent, const GuidedOptions& options)
    : options_(options),
      grid_(extent, kGuidedTile, kGuidedTile),
      skipped_(static_cast<std::size_t>(grid_.count())) {
  options.validate();
}

GuidedFilter::~GuidedFilter() = default;

std::int64_t GuidedFilter::process(const GuidedInputs& in, Planes<3>& out) {
  const Extent extent = grid_.extent();
  const auto fits = [&](const Planes<3>& planes) {
    return planes[0].extent() == extent && planes[1].extent() == extent &&
           planes[2].extent() == extent;
  };
  EL_CHECK(in.guides.extent() == extent && fits(in.signal) && in.weight.extent() == extent &&
               in.wanted.extent() == extent && fits(out),
           "guided filter made for {}x{}: got planes of another size", extent.width, extent.height);
  EL_CHECK(&in.signal != &out, "guided filter: the output must not be the signal itself");
  for_each_tile(grid_, [&](const Tile& tile) {
    const bool wanted = any_wanted(in.wanted, tile);
    skipped_[static_cast<std::size_t>(tile.index)] = wanted ? 0 : tile.pixels();
    if (!wanted) return;
    auto scratch = take_scratch();
    guided_tile(in, options_, tile, *scratch, out);
    give_back(std::move(scratch));
  });
  return std::accumulate(skipped_.begin(), skipped_.end(), std::int64_t{0});
}

std::unique_ptr<GuidedScratch> GuidedFilter::take_scratch() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) return std::make_unique<GuidedScratch>();
  auto scratch = std::move(spare_.back());
  spare_.pop_back();
  return scratch;
}

void GuidedFilter::give_back(std::unique_ptr<GuidedScratch> scratch) {
  const std::lock_guard lock(mutex_);
  spare_.push_back(std::move(scratch));
}

}  // namespace eigenlight
