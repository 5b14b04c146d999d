#include "spatial/guided_filter.h"

#include <algorithm>
#include <cmath>

#include "frame/usable_surface.h"
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

// Of every eighth pixel of every eighth row. It may be rough but must be the same for all runs.
float mean_log_depth(const FrameInput& frame) {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < frame.extent().height; y += 8) {
    for (int x = 0; x < frame.extent().width; x += 8) {
      if (!is_usable_surface(frame.surface, x, y)) continue;
      sum += std::log(static_cast<double>(frame.surface.depth(x, y)));
      count += 1.0;
    }
  }
  return count > 0.0 ? static_cast<float>(sum / count) : 0.0f;
}

}  // namespace

void GuidedOptions::validate() const {
  EL_CHECK(radius >= 1 && radius <= kGuidedRadius, "guided filter radius {}: expected 1 to {}",
           radius, kGuidedRadius);
  EL_CHECK(
      guides == Guides::kGrayNormal || guides == Guides::kNormal || guides == Guides::kNormalDepth,
      "guided filter guides {}: expected 1, 3 or 4", static_cast<int>(guides));
  EL_CHECK(epsilon_normal >= 1e-4f && epsilon_normal <= 1.0f,
           "epsilon_normal {}: expected [1e-4, 1]", epsilon_normal);
  EL_CHECK(epsilon_depth >= 1e-4f && epsilon_depth <= 1.0f, "epsilon_depth {}: expected [1e-4, 1]",
           epsilon_depth);
}

GuidedFilter::GuidedFilter(Extent extent, const GuidedOptions& options)
    : options_(options), grid_(extent, kGuidedTile, kGuidedTile), wanted_(grid_) {
  options.validate();
  runs_.reserve(static_cast<std::size_t>(grid_.count()));
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
  plan_runs(in.wanted);
  if (!runs_.empty()) {
    const GuidedWork work{in, options_, mean_log_depth(in.guides)};
    parallel_for(static_cast<int>(runs_.size()), [&](int i) {
      auto scratch = take_scratch();
      guided_run(work, runs_[static_cast<std::size_t>(i)], *scratch, out);
      give_back(std::move(scratch));
    });
  }
  auto skipped = static_cast<std::int64_t>(extent.pixels());
  for (const Tile& run : runs_) skipped -= run.pixels();
  return skipped;
}

// Neighboring tiles that form a rectangle within a strip are filtered as one run: they share their
// halos.
void GuidedFilter::plan_runs(const Plane<std::uint8_t>& wanted) {
  for_each_tile(grid_, [&](const Tile& tile) { wanted_[tile] = any_wanted(wanted, tile) ? 1 : 0; });
  runs_.clear();
  const int strip = guided_strip(options_.radius) / kGuidedTile;
  for (int left = 0; left < grid_.columns(); left += strip) {
    const std::size_t first = runs_.size();
    const int right = std::min(left + strip, grid_.columns());
    for (int row = 0; row < grid_.rows(); ++row) {
      for (int column = left; column < right; ++column) {
        if (wanted_[row * grid_.columns() + column] == 0) continue;
        Tile run = grid_.tile(row * grid_.columns() + column);
        while (column + 1 < right && wanted_[run.index + 1] != 0) {
          run.x1 = grid_.tile(++run.index).x1;
          ++column;
        }
        add_run(run, first);
      }
    }
  }
}

// Joins `run` to the run directly above it, if there is one among those from number `first` on.
void GuidedFilter::add_run(const Tile& run, std::size_t first) {
  for (std::size_t i = first; i < runs_.size(); ++i) {
    if (runs_[i].y1 == run.y0 && runs_[i].x0 == run.x0 && runs_[i].x1 == run.x1) {
      runs_[i].y1 = run.y1;
      return;
    }
  }
  runs_.push_back(run);
}

std::unique_ptr<GuidedScratch> GuidedFilter::take_scratch() {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) {
    return std::make_unique<GuidedScratch>(options_.radius, static_cast<int>(options_.guides));
  }
  auto scratch = std::move(spare_.back());
  spare_.pop_back();
  return scratch;
}

void GuidedFilter::give_back(std::unique_ptr<GuidedScratch> scratch) {
  const std::lock_guard lock(mutex_);
  spare_.push_back(std::move(scratch));
}

}  // namespace eigenlight
