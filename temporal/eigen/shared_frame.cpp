#include "temporal/eigen/shared_frame.h"

#include <utility>

#include "frame/guides.h"
#include "temporal/change/edges.h"
#include "temporal/samples/guides.h"

namespace eigenlight {
namespace {

template <typename T>
void own(Plane<T>& plane) {
  if (plane.is_view()) plane = plane.clone();
}

}  // namespace

SharedFrame::SharedFrame(Extent extent, const EigenOptions& options)
    : options_(options),
      tiles_(extent, kCoefficientTile, kCoefficientTile),
      surfaces_(extent),
      counts_(tiles_),
      budget_(extent, options.budget),
      edge_(extent),
      extra_(extent) {}

bool SharedFrame::read(FrameSource& source, int layers) {
  if (std::exchange(is_finished_, false)) surfaces_.take(frame_);
  if (!source.next(frame_)) return false;
  const Extent extent = tiles_.extent();
  EL_CHECK(frame_.extent() == extent, "frame {} is {}x{}, expected {}x{}", frame_.index,
           frame_.extent().width, frame_.extent().height, extent.width, extent.height);
  EL_CHECK(frame_.lights.size() == static_cast<std::size_t>(layers),
           "frame {} has {} layers of light, expected {}", frame_.index, frame_.lights.size(),
           layers);
  // These planes are edited where they are unusable, and kept for the next frame.
  own(frame_.surface.depth);
  own(frame_.surface.id);
  for (auto& plane : frame_.surface.normal) own(plane);
  is_cut_ = !surfaces_.is_followed_by(frame_);
  is_still_ = options_.skip_still && !is_cut_ && frame_.is_static;
  has_edges_ = is_moving() && options_.max_age_edge < options_.innovation.max_age;
  counts_.fill({});
  return true;
}

void SharedFrame::check_surfaces(const Tile& row) {
  const PixelCounts found = count_guides(frame_.surface, row);
  counts_[row] += found;
  if (found.unguided == 0) return;
  for (int x = row.x0; x < row.x1; ++x) {
    if (frame_.surface.id(x, row.y0) != 0 && !has_usable_guides(frame_.surface, x, row.y0)) {
      drop_guides(frame_, x, row.y0);
    }
  }
}

void SharedFrame::find_taps(const Tile& row, TapSegment& taps) {
  compute_taps(frame_, surfaces_.previous(), options_.taps, row, taps);
  if (has_edges_) find_edges(frame_, options_.taps, row, edge_);
}

std::int64_t SharedFrame::plan_samples(const Plane<float>& age) {
  return budget_.process(frame_, age, extra_).samples;
}

void SharedFrame::reset() {
  surfaces_.reset();
  is_finished_ = false;
}

void SharedFrame::save(StateWriter& out) const {
  is_finished_ ? SurfaceHistory::save(out, frame_) : surfaces_.save(out);
}

void SharedFrame::load(StateReader& in) {
  surfaces_.load(in);
  is_finished_ = false;
}

}  // namespace eigenlight
