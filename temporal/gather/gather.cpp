#include "temporal/gather/gather.h"

#include <array>
#include <cmath>

#include "frame/check.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

// Below the square of any light that can be seen.
constexpr float kTiny = 1e-12f;

struct Place {
  float x, y, log_depth;
};

struct Taps {
  std::array<int, 4> x, y;
  std::array<float, 4> weight;
  float total;
};

// Sets the four pixels around a place. False where none matches.
bool find_taps(const Plane<PackedGuide>& there, const PackedGuide& guide, const Place& place,
               const GuideWidths& widths, Taps& taps) {
  const Extent extent = there.extent();
  if (!(place.x > -1.0f && place.y > -1.0f && place.x < static_cast<float>(extent.width) &&
        place.y < static_cast<float>(extent.height))) {
    return false;
  }
  const float left = std::floor(place.x), top = std::floor(place.y);
  const float fx = place.x - left, fy = place.y - top;
  const std::int32_t steps = depth_steps(place.log_depth, widths);
  taps.total = 0.0f;
  for (std::size_t t = 0; t < 4; ++t) {
    const bool is_right = t % 2 != 0, is_low = t / 2 != 0;
    const int x = static_cast<int>(left) + is_right, y = static_cast<int>(top) + is_low;
    const bool is_inside = extent.contains(x, y);
    taps.x[t] = is_inside ? x : 0;
    taps.y[t] = is_inside ? y : 0;
    const float bilinear = (is_right ? fx : 1.0f - fx) * (is_low ? fy : 1.0f - fy);
    taps.weight[t] = is_inside ? bilinear * guide_weight(guide, there(x, y), steps) : 0.0f;
    taps.total += taps.weight[t];
  }
  return taps.total >= kLeastMatch;
}

// Goes on by the links of the pixels around a place. False where half of them are not known.
bool follow_link(const FrameLink& link, const Taps& taps, Place& place) {
  Link sum{};
  for (std::size_t t = 0; t < 4; ++t) {
    const Link& from = link(taps.x[t], taps.y[t]);
    sum.x += taps.weight[t] * from.x;
    sum.y += taps.weight[t] * from.y;
    sum.log_depth += taps.weight[t] * from.log_depth;
    sum.known += taps.weight[t] * from.known;
  }
  if (sum.known < 0.5f * taps.total) return false;
  const float over = 1.0f / sum.known;
  place = {place.x + sum.x * over, place.y + sum.y * over, place.log_depth + sum.log_depth * over};
  return true;
}

// What another frame says of one pixel's light.
struct Candidate {
  RecordedLight light;
  float match, gain, trust;  // trust: weight by the change of light on the way
};

struct Candidates {
  std::array<Candidate, 2 * kMostGathered> list;
  std::size_t count = 0;
};

void add_candidate(const LightRecord& record, const Taps& taps, float gain, float trust,
                   Candidates& out) {
  RecordedLight sum{};
  for (std::size_t t = 0; t < 4; ++t) {
    const RecordedLight& from = record(taps.x[t], taps.y[t]);
    const float w = taps.weight[t];
    sum.r += w * from.r;
    sum.g += w * from.g;
    sum.b += w * from.b;
    sum.pilot += w * from.pilot;
    sum.pilot_variance += w * from.pilot_variance;
    sum.noise += w * from.noise;
    sum.usable += w * from.usable;
  }
  if (sum.usable < 0.5f * taps.total || out.count == out.list.size()) return;
  const float match = std::min(sum.usable, 1.0f), over = 1.0f / sum.usable;
  for (float* value : {&sum.r, &sum.g, &sum.b, &sum.pilot, &sum.pilot_variance, &sum.noise}) {
    *value *= over;
  }
  out.list[out.count++] = {sum, match, gain, trust};
}

// The noise of light and pilots over all frames.
struct MeanNoise {
  float light = 0.0f, pilot = 0.0f;
};

MeanNoise mean_noise(const RecordedLight& own, const Candidates& found) {
  float total = own.usable;
  MeanNoise noise{own.usable * own.noise, own.usable * own.pilot_variance};
  for (std::size_t i = 0; i < found.count; ++i) {
    const Candidate& other = found.list[i];
    total += other.match;
    noise.light += other.match * other.light.noise;
    noise.pilot += other.match * other.light.pilot_variance;
  }
  const float over = total > 0.0f ? 1.0f / total : 0.0f;
  return {noise.light * over, noise.pilot * over};
}

class Gatherer {
 public:
  Gatherer(const Plane<PackedGuide>& guides, const GuideWidths& widths,
           std::span<const GatherWalk> walks, std::span<const GatherLayer> layers,
           const GatherOptions& options)
      : guides_(guides), widths_(widths), walks_(walks), layers_(layers), options_(options) {}

  void row(int y) const {
    std::vector<Candidates> found(layers_.size());
    for (int x = 0; x < guides_.width(); ++x) {
      if (!shows_surface(guides_(x, y))) continue;
      for (Candidates& layer : found) layer.count = 0;
      for (const GatherWalk& walk : walks_) follow(walk, x, y, found);
      for (std::size_t i = 0; i < layers_.size(); ++i) merge(layers_[i], x, y, found[i]);
    }
  }

 private:
  // The light of all layers along a walk.
  void follow(const GatherWalk& walk, int x, int y, std::vector<Candidates>& found) const {
    if (walk.empty()) return;
    const Link& first = (*walk.front().link)(x, y);
    if (first.known == 0.0f) return;
    Place before{static_cast<float>(x), static_cast<float>(y), 0.0f};
    Place place{before.x + first.x, before.y + first.y, first.log_depth};
    std::array<float, kMaxLights> gain, change{};
    gain.fill(1.0f);
    Taps taps;
    for (std::size_t s = 0; s < walk.size(); ++s) {
      const GatherStep& step = walk[s];
      if (s > 0) {
        before = place;
        if (!follow_link(*step.link, taps, place)) return;
      }
      if (!find_taps(*step.guides, guides_(x, y), place, widths_, taps)) return;
      for (std::size_t i = 0; i < layers_.size(); ++i) {
        if (step.changes[i]) {
          gain[i] *= step.changes[i]->at(before.x, before.y);
          change[i] = std::max(change[i], std::abs(std::log(gain[i])) / options_.change);
        }
        if (!step.lights[i]) continue;
        add_candidate(*step.lights[i], taps, gain[i], 1.0f / (1.0f + change[i] * change[i]),
                      found[i]);
      }
    }
  }

  [[nodiscard]] float weight(const GatherLayer& layer, const RecordedLight& own,
                             const Candidate& other, const MeanNoise& noise) const {
    if (layer.count || own.usable == 0.0f) return other.match * other.trust;
    const float d = other.light.pilot - own.pilot;
    const float ratio = d * d / (2.0f * noise.pilot + kTiny);
    return other.match * falloff(options_.slope * std::max(0.0f, ratio - options_.soft));
  }

  void merge(const GatherLayer& layer, int x, int y, const Candidates& found) const {
    const RecordedLight& own = (*layer.own)(x, y);
    const MeanNoise noise = mean_noise(own, found);
    Planes<3>& light = *layer.light;
    float r = light[0](x, y), g = light[1](x, y), b = light[2](x, y);
    float& variance = (*layer.variance)(x, y);
    float total = layer.count ? std::max((*layer.count)(x, y), 1.0f) : 1.0f;
    float spread = total * total * (layer.count ? variance : noise.light);
    if (!std::isfinite(r + g + b + spread)) r = g = b = total = spread = 0.0f;
    r *= total, g *= total, b *= total;
    for (std::size_t i = 0; i < found.count; ++i) {
      const Candidate& other = found.list[i];
      const float w = weight(layer, own, other, noise), scaled = w * other.gain;
      r += scaled * other.light.r;
      g += scaled * other.light.g;
      b += scaled * other.light.b;
      total += w;
      spread += scaled * scaled * noise.light;
    }
    if (total <= 0.0f) return;
    const float over = 1.0f / total;
    light[0](x, y) = r * over, light[1](x, y) = g * over, light[2](x, y) = b * over;
    variance = spread * over * over;
  }

  const Plane<PackedGuide>& guides_;
  const GuideWidths& widths_;
  std::span<const GatherWalk> walks_;
  std::span<const GatherLayer> layers_;
  const GatherOptions& options_;
};

}  // namespace

void GatherOptions::validate() const {
  EL_CHECK(soft >= 0.0f && soft <= 100.0f, "soft {}: expected [0, 100]", soft);
  EL_CHECK(slope >= 0.0f && slope <= 100.0f, "slope {}: expected [0, 100]", slope);
  EL_CHECK(change > 0.0f && change <= 10.0f, "change {}: expected (0, 10]", change);
}

void gather(const Plane<PackedGuide>& guides, const GuideWidths& widths,
            std::span<const GatherWalk> walks, std::span<const GatherLayer> layers,
            const GatherOptions& options) {
  const Gatherer gatherer(guides, widths, walks, layers, options);
  parallel_for(guides.height(), [&](int y) { gatherer.row(y); });
}

}  // namespace eigenlight
