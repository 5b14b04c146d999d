#include "temporal/baselines/point_tracks.h"

#include <algorithm>
#include <cmath>

#include "temporal/baselines/point_taps.h"

namespace eigenlight {
namespace {

constexpr float kCovered = 0.5f;  // below: a pixel starts a point
constexpr float kCrowded = 2.0f;  // from here on: further points end
constexpr int kChunk = 4096;      // points that one thread follows at a time

struct LivePoint {
  std::uint32_t track = 0;
  SoughtPoint point;
};

glm::vec3 at(const Planes<3>& planes, glm::ivec2 p) {
  return {planes[0](p.x, p.y), planes[1](p.x, p.y), planes[2](p.x, p.y)};
}

bool is_finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Reads what the frame shows at a point's taps and moves the point to the frame before.
TrackSample read_and_move(const FrameInput& frame, const PointTaps& taps, LivePoint& live) {
  TrackSample sample{live.track, taps.corner, taps.weight, glm::vec3(0.0f), false};
  glm::vec2 motion(0.0f);
  float share = 0.0f, strongest = 0.0f, depth = 0.0f;
  for (std::size_t t = 0; t < 4; ++t) {
    const float weight = taps.weight[t];
    if (!(weight > 0.0f)) continue;
    const glm::ivec2 q = taps.tap(t);
    const glm::vec3 light = at(frame.lights[0].radiance, q);
    if (is_finite(light)) {
      sample.light += weight * light;
      share += weight;
    }
    motion += weight * glm::vec2(frame.motion[0](q.x, q.y), frame.motion[1](q.x, q.y));
    depth += weight * frame.previous_depth(q.x, q.y);
    if (weight <= strongest) continue;
    strongest = weight;
    live.point.normal = at(frame.surface.normal, q);
  }
  sample.is_usable = share > 0.0f;
  if (sample.is_usable) sample.light /= share;
  live.point.pixel += motion;
  live.point.depth = depth;
  return sample;
}

// One frame's points: those that come from the frame after it, and its own.
class FramePoints {
 public:
  FramePoints(const FrameInput& frame, const TapOptions& options, std::vector<LivePoint>& live)
      : frame_(frame), options_(options), live_(live), coverage_(frame.extent()) {}

  std::vector<TrackSample> find(std::uint32_t& count) {
    follow();
    for (int y = 0; y < coverage_.height(); ++y) {
      for (int x = 0; x < coverage_.width(); ++x) {
        if (frame_.surface.id(x, y) == 0 || coverage_(x, y) >= kCovered) continue;
        start({x, y}, count++);
      }
    }
    return std::move(samples_);
  }

 private:
  void follow() {
    std::vector<PointTaps> taps(live_.size());
    const int points = static_cast<int>(live_.size());
    parallel_for((points + kChunk - 1) / kChunk, [&](int chunk) {
      for (int i = chunk * kChunk; i < std::min(points, (chunk + 1) * kChunk); ++i) {
        const auto index = static_cast<std::size_t>(i);
        taps[index] = point_taps({frame_.camera, frame_.surface}, options_, live_[index].point);
      }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < live_.size(); ++i) {
      if (!taps[i].found() || is_crowded(taps[i])) continue;
      live_[kept] = live_[i];
      samples_.push_back(read_and_move(frame_, taps[i], live_[kept]));
      ++kept;
      for (std::size_t t = 0; t < 4; ++t) {
        const glm::ivec2 q = taps[i].tap(t);
        if (taps[i].weight[t] > 0.0f) coverage_(q.x, q.y) += taps[i].weight[t];
      }
    }
    live_.resize(kept);
  }

  [[nodiscard]] bool is_crowded(const PointTaps& taps) const {
    for (std::size_t t = 0; t < 4; ++t) {
      const glm::ivec2 q = taps.tap(t);
      if (taps.weight[t] > 0.0f && coverage_(q.x, q.y) < kCrowded) return false;
    }
    return true;
  }

  void start(glm::ivec2 p, std::uint32_t track) {
    LivePoint live{track,
                   {frame_.surface.id(p.x, p.y), at(frame_.surface.normal, p), glm::vec2(p),
                    frame_.surface.depth(p.x, p.y)}};
    const PointTaps own{p, {1.0f, 0.0f, 0.0f, 0.0f}};
    samples_.push_back(read_and_move(frame_, own, live));
    live_.push_back(live);
  }

  const FrameInput& frame_;
  const TapOptions& options_;
  std::vector<LivePoint>& live_;
  Plane<float> coverage_;
  std::vector<TrackSample> samples_;
};

}  // namespace

PointTracks::PointTracks(std::span<const Frame* const> frames, const TapOptions& options)
    : samples_(frames.size()) {
  EL_CHECK(!frames.empty(), "no frames to follow points through");
  std::vector<LivePoint> live;
  for (std::size_t t = frames.size(); t-- > 0;) {
    EL_CHECK(frames[t]->extent() == frames[0]->extent(), "frame {} has another size than frame {}",
             frames[t]->index, frames[0]->index);
    samples_[t] = FramePoints(*frames[t], options, live).find(count_);
  }
}

std::span<const TrackSample> PointTracks::samples(int t, std::uint32_t first,
                                                  std::uint32_t last) const {
  const auto& all = samples_[static_cast<std::size_t>(t)];
  const auto from = [&](std::uint32_t track) {
    return std::lower_bound(all.begin(), all.end(), track,
                            [](const TrackSample& s, std::uint32_t id) { return s.track < id; });
  };
  return {from(first), from(last)};
}

}  // namespace eigenlight
