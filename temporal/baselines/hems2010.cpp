#include "temporal/baselines/hems2010.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 1;

glm::vec3 at(const Planes<3>& planes, glm::ivec2 p) {
  return {planes[0](p.x, p.y), planes[1](p.x, p.y), planes[2](p.x, p.y)};
}

// |a - b|^2 over the mean of |a|^2 and |b|^2.
float difference(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 apart = a - b;
  const float size = 0.5f * (glm::dot(a, a) + glm::dot(b, b));
  return size > 0.0f ? glm::dot(apart, apart) / size : 0.0f;
}

// Saves or loads a past frame.
template <typename PastFrame, typename State>
void archive(PastFrame& past, State& state) {
  state.value("index", past.index);
  state.value("camera", past.camera);
  state.plane("depth", past.surface.depth);
  state.planes("normal", past.surface.normal);
  state.plane("id", past.surface.id);
  state.planes("motion", past.motion);
  state.plane("previous depth", past.previous_depth);
  state.planes("light", past.light);
  state.plane("known", past.known);
}

}  // namespace

void HemsOptions::validate() const {
  EL_CHECK(frames >= 0 && frames <= 16, "frames {}: expected 0 to 16", frames);
  EL_CHECK(radius >= 0 && radius <= 16, "radius {}: expected 0 to 16 pixels", radius);
  EL_CHECK(color > 0.0f && color <= 100.0f, "color {}: expected (0, 100]", color);
  taps.validate();
}

Hems2010::Hems2010(const DenoiserOptions& options, const HemsOptions& parts)
    : options_(parts),
      tiles_(stage_tiles(options.extent)),
      light_(make_planes<3>(options.extent)),
      smooth_(make_planes<3>(options.extent)),
      output_(make_planes<3>(options.extent)),
      usable_(options.extent),
      known_(options.extent),
      age_(options.extent),
      counts_(static_cast<std::size_t>(tiles_.count())) {
  parts.validate();
  // Light is divided by albedo, so the window ignores albedo: 10 exceeds all of its differences.
  const CrossBilateralOptions window{.radius = parts.radius, .sigma_albedo = 10.0f};
  if (parts.radius > 0) window_ = std::make_unique<CrossBilateral>(options.extent, window);
}

const Planes<3>* Hems2010::step(FrameSource& source) {
  StageClock clock;
  if (!source.next(frame_)) return nullptr;
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  const Extent extent = tiles_.extent();
  EL_CHECK(frame_.extent() == extent, "frame {} is {}x{}, expected {}x{}", frame_.index,
           frame_.extent().width, frame_.extent().height, extent.width, extent.height);
  report_.cut = past_.empty() || past_.front().index != frame_.previous_index;
  if (report_.cut) past_.clear();
  const auto for_tiles = [&](void (Hems2010::*work)(const Tile&, PixelCounts&)) {
    for_each_tile(tiles_, [&](const Tile& tile) {
      (this->*work)(tile, counts_[static_cast<std::size_t>(tile.index)]);
    });
  };
  for_tiles(&Hems2010::take_light);
  smooth();
  report_[Stage::kFilter] = clock.lap();
  for_tiles(&Hems2010::gather);
  keep();
  report_[Stage::kWarp] = clock.lap();

  report_.frame = frame_.index;
  for (const PixelCounts& counts : counts_) counts.add_to(report_);
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &output_;
}

// u where it is usable.
void Hems2010::take_light(const Tile& tile, PixelCounts& counts) {
  const auto& u = frame_.lights[0].radiance;
  counts = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool usable = counts.add(frame_, x, y);
      usable_(x, y) = usable ? 1.0f : 0.0f;
      for (std::size_t c = 0; c < 3; ++c) light_[c](x, y) = usable ? u[c](x, y) : 0.0f;
    }
  }
}

void Hems2010::smooth() {
  if (!window_) {
    copy_planes(light_, smooth_);
    known_.copy_from(usable_);
    return;
  }
  window_->process({frame_, light_, usable_}, smooth_);
  for_each_tile(tiles_, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        // The filter gives 0 where no usable pixel is near.
        const bool filled = usable_(x, y) > 0.0f || at(smooth_, {x, y}) != glm::vec3(0.0f);
        known_(x, y) = filled ? 1.0f : 0.0f;
      }
    }
  });
}

void Hems2010::gather(const Tile& tile, PixelCounts& counts) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      for (auto& plane : output_) plane(x, y) = 0.0f;
      age_(x, y) = 0.0f;
      if (frame_.surface.id(x, y) != 0 && !gather_pixel({x, y})) ++counts.fresh;
    }
  }
}

// What a past frame shows of a point through its taps.
Hems2010::Seen Hems2010::look(const PastFrame& past, const PointTaps& taps) {
  Seen seen;
  float strongest = 0.0f;
  for (std::size_t t = 0; t < 4; ++t) {
    const float weight = taps.weight[t];
    if (!(weight > 0.0f)) continue;
    const glm::ivec2 q = taps.tap(t);
    seen.light += weight * past.known(q.x, q.y) * at(past.light, q);
    seen.known += weight * past.known(q.x, q.y);
    seen.motion += weight * glm::vec2(past.motion[0](q.x, q.y), past.motion[1](q.x, q.y));
    seen.previous_depth += weight * past.previous_depth(q.x, q.y);
    if (weight <= strongest) continue;
    strongest = weight;
    seen.normal = at(past.surface.normal, q);
  }
  return seen;
}

bool Hems2010::gather_pixel(glm::ivec2 p) {
  const glm::vec3 own = at(smooth_, p);
  const bool known = known_(p.x, p.y) > 0.0f;
  glm::vec3 sum = own;
  float weights = known ? 1.0f : 0.0f, squares = weights;
  SoughtPoint point{
      frame_.surface.id(p.x, p.y), at(frame_.surface.normal, p),
      glm::vec2(p) + glm::vec2(frame_.motion[0](p.x, p.y), frame_.motion[1](p.x, p.y)),
      frame_.previous_depth(p.x, p.y)};
  bool found = false;
  for (const PastFrame& past : past_) {
    const PointTaps taps = point_taps({past.camera, past.surface}, options_.taps, point);
    if (!taps.found()) break;
    found = true;
    const Seen seen = look(past, taps);
    point = {point.id, seen.normal, point.pixel + seen.motion, seen.previous_depth};
    if (!(seen.known > 0.0f)) continue;
    const glm::vec3 light = seen.light / seen.known;
    const float apart = known ? difference(light, own) : 0.0f;
    const float weight = std::exp(-apart / (2.0f * options_.color * options_.color));
    sum += weight * light;
    weights += weight;
    squares += weight * weight;
  }
  if (weights > 0.0f) {
    for (int c = 0; c < 3; ++c) output_[c](p.x, p.y) = sum[c] / weights;
    age_(p.x, p.y) = weights * weights / squares;
  }
  return found;
}

// Puts this frame before the others and reuses the planes of the oldest one.
void Hems2010::keep() {
  if (options_.frames == 0) return;
  if (past_.size() < static_cast<std::size_t>(options_.frames)) past_.emplace_back();
  std::rotate(past_.begin(), past_.end() - 1, past_.end());
  PastFrame& now = past_.front();
  const Extent extent = tiles_.extent();
  now.index = frame_.index;
  now.camera = frame_.camera;
  const auto copy = [&](const auto& from, auto& to) {
    ensure_extent(to, extent);
    to.copy_from(from);
  };
  copy(frame_.surface.depth, now.surface.depth);
  copy(frame_.surface.id, now.surface.id);
  copy(frame_.previous_depth, now.previous_depth);
  copy(known_, now.known);
  for (std::size_t c = 0; c < 3; ++c) {
    copy(frame_.surface.normal[c], now.surface.normal[c]);
    copy(smooth_[c], now.light[c]);
    if (c < 2) copy(frame_.motion[c], now.motion[c]);
  }
}

void Hems2010::save(StateWriter& out) const {
  out.value("hems2010", kStateVersion);
  out.value("frames", past_.size());
  for (const PastFrame& past : past_) archive(past, out);
}

void Hems2010::load(StateReader& in) {
  in.version("hems2010", kStateVersion);
  std::size_t frames = 0;
  in.value("frames", frames);
  if (frames > static_cast<std::size_t>(options_.frames)) {
    throw std::runtime_error(fmt::format("state of 'hems2010': {} past frames, expected up to {}",
                                         frames, options_.frames));
  }
  past_ = std::vector<PastFrame>(frames);
  for (PastFrame& past : past_) {
    archive(past, in);
    const Extent wanted = tiles_.extent();
    const Extent found = past.known.extent();
    if (found != wanted) {
      throw std::runtime_error(fmt::format("state of 'hems2010': {}x{}, expected {}x{}",
                                           found.width, found.height, wanted.width, wanted.height));
    }
  }
}

}  // namespace eigenlight
