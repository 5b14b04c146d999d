// gather() as its header writes it down, in double, pixel by pixel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "temporal/gather/gather.h"

namespace eigenlight::reference {

/// One layer of the frame at hand, and what gather() makes of one pixel of it.
struct GatherSetting {
  const Plane<PackedGuide>& guides;
  const GuideWidths& widths;
  const std::vector<GatherWalk>& walks;
  const GatherOptions& options;
};

struct GatherPixel {
  std::array<double, 3> light;
  double variance;
};

class SlowGather {
 public:
  explicit SlowGather(const GatherSetting& setting) : in_(setting) {}

  /// `layer` of all walks, whose light is still the estimate.
  [[nodiscard]] GatherPixel pixel(const GatherLayer& layer, std::size_t index, int x, int y) const {
    GatherPixel out{{value((*layer.light)[0], x, y), value((*layer.light)[1], x, y),
                     value((*layer.light)[2], x, y)},
                    value(*layer.variance, x, y)};
    if (!shows_surface(in_.guides(x, y))) return out;
    const GatherPixel before = out;
    std::vector<Found> found;
    for (const GatherWalk& walk : in_.walks) follow(walk, index, x, y, found);
    const RecordedLight& own = (*layer.own)(x, y);
    const double noise = mean(own, &RecordedLight::noise, found);
    const double pilots = mean(own, &RecordedLight::pilot_variance, found);
    double n = layer.count ? std::max(value(*layer.count, x, y), 1.0) : 1.0;
    double spread = n * n * (layer.count ? out.variance : noise);
    if (!std::isfinite(out.light[0] + out.light[1] + out.light[2] + spread)) {
      out.light = {}, n = 0.0, spread = 0.0;
    }
    for (double& c : out.light) c *= n;
    for (const Found& frame : found) {
      const bool is_tested = !layer.count && own.usable != 0.0f;
      const double w = frame.match * (is_tested ? test(frame, own, pilots) : frame.trust);
      for (std::size_t c = 0; c < 3; ++c) out.light[c] += w * frame.gain * frame.light[c];
      spread += std::pow(w * frame.gain, 2.0) * noise;
      n += w;
    }
    if (n == 0.0) return before;
    for (double& c : out.light) c /= n;
    out.variance = spread / (n * n);
    return out;
  }

 private:
  // Where a pixel is in another frame.
  struct Place {
    double x, y, log_depth;
  };
  struct Tap {
    int x, y;
    double weight;
  };
  struct Found {
    std::array<double, 3> light;
    double pilot, pilot_variance, noise, match, gain, trust;
  };

  template <typename T>
  [[nodiscard]] static double value(const Plane<T>& plane, int x, int y) {
    return static_cast<double>(plane(x, y));
  }

  [[nodiscard]] std::vector<Tap> taps(const Plane<PackedGuide>& there, const PackedGuide& guide,
                                      const Place& place) const {
    std::vector<Tap> found;
    const int steps = depth_steps(static_cast<float>(place.log_depth), in_.widths);
    for (int y = 0; y < there.height(); ++y) {
      for (int x = 0; x < there.width(); ++x) {
        const double near =
            std::max(1.0 - std::abs(place.x - x), 0.0) * std::max(1.0 - std::abs(place.y - y), 0.0);
        if (near == 0.0) continue;
        double square = std::pow(guide.depth + steps - there(x, y).depth, 2.0) +
                        std::pow(guide.other - there(x, y).other, 2.0);
        for (std::size_t i = 0; i < 6; ++i) {
          square += std::pow(guide.normal_color[i] - there(x, y).normal_color[i], 2.0);
        }
        square /= 256.0 * 256.0;
        found.push_back({x, y, square < 8.0 ? near * std::pow(1.0 - square / 8.0, 8.0) : 0.0});
      }
    }
    return found;
  }

  [[nodiscard]] static double total(const std::vector<Tap>& taps) {
    double sum = 0.0;
    for (const Tap& tap : taps) sum += tap.weight;
    return sum;
  }

  [[nodiscard]] static std::optional<Place> next(const FrameLink& link,
                                                 const std::vector<Tap>& taps, const Place& place) {
    double x = 0.0, y = 0.0, log_depth = 0.0, known = 0.0;
    for (const Tap& tap : taps) {
      const Link& to = link(tap.x, tap.y);
      if (to.known == 0.0f) continue;
      x += tap.weight * static_cast<double>(to.x);
      y += tap.weight * static_cast<double>(to.y);
      log_depth += tap.weight * static_cast<double>(to.log_depth);
      known += tap.weight;
    }
    if (known < 0.5 * total(taps)) return std::nullopt;
    return Place{place.x + x / known, place.y + y / known, place.log_depth + log_depth / known};
  }

  // What a frame says of the pixel, if half of what matches can be used.
  [[nodiscard]] static std::optional<Found> light_at(const LightRecord& record,
                                                     const std::vector<Tap>& taps) {
    Found sum{};
    for (const Tap& tap : taps) {
      const RecordedLight& from = record(tap.x, tap.y);
      if (from.usable == 0.0f) continue;
      const std::array<float, 3> light{from.r, from.g, from.b};
      for (std::size_t c = 0; c < 3; ++c) {
        sum.light[c] += tap.weight * static_cast<double>(light[c]);
      }
      sum.pilot += tap.weight * static_cast<double>(from.pilot);
      sum.pilot_variance += tap.weight * static_cast<double>(from.pilot_variance);
      sum.noise += tap.weight * static_cast<double>(from.noise);
      sum.match += tap.weight;
    }
    if (sum.match < 0.5 * total(taps)) return std::nullopt;
    for (double& c : sum.light) c /= sum.match;
    sum.pilot /= sum.match, sum.pilot_variance /= sum.match, sum.noise /= sum.match;
    return sum;
  }

  void follow(const GatherWalk& walk, std::size_t layer, int x, int y,
              std::vector<Found>& found) const {
    Place place{static_cast<double>(x), static_cast<double>(y), 0.0};
    std::vector<Tap> here{{x, y, 1.0}};
    double gain = 1.0, change = 0.0;
    for (const GatherStep& step : walk) {
      const std::optional<Place> there = next(*step.link, here, place);
      if (!there) return;
      if (step.changes[layer]) {
        gain *= static_cast<double>(
            step.changes[layer]->at(static_cast<float>(place.x), static_cast<float>(place.y)));
      }
      change = std::max(change, std::abs(std::log(gain)) / static_cast<double>(in_.options.change));
      place = *there;
      here = taps(*step.guides, in_.guides(x, y), place);
      if (total(here) < static_cast<double>(kLeastMatch)) return;
      if (!step.lights[layer]) continue;
      std::optional<Found> light = light_at(*step.lights[layer], here);
      if (!light) continue;
      light->gain = gain;
      light->trust = 1.0 / (1.0 + change * change);
      found.push_back(*light);
    }
  }

  // Over the frame at hand and all that were found, by how well they match.
  [[nodiscard]] static double mean(const RecordedLight& own, float RecordedLight::*member,
                                   const std::vector<Found>& found) {
    double sum = static_cast<double>(own.usable * own.*member);
    double weights = static_cast<double>(own.usable);
    for (const Found& frame : found) {
      sum += frame.match * (member == &RecordedLight::noise ? frame.noise : frame.pilot_variance);
      weights += frame.match;
    }
    return weights > 0.0 ? sum / weights : 0.0;
  }

  [[nodiscard]] double test(const Found& frame, const RecordedLight& own, double pilots) const {
    const double square = std::pow(frame.pilot - static_cast<double>(own.pilot), 2.0);
    const double excess = square / (2.0 * pilots) - static_cast<double>(in_.options.soft);
    const double far = static_cast<double>(in_.options.slope) * std::max(excess, 0.0);
    return far < 8.0 ? std::pow(1.0 - far / 8.0, 8.0) : 0.0;
  }

  GatherSetting in_;
};

}  // namespace eigenlight::reference
