// gather() as its header writes it down, in double, pixel by pixel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "temporal/gather/gather.h"

namespace eigenlight::reference {

struct GatherSetting {
  const Plane<PackedGuide>& guides;
  const GuideWidths& widths;
  const std::vector<GatherWalk>& walks;
};

/// What gather() makes of one pixel of a layer.
struct GatherPixel {
  std::array<double, 3> light;
  double variance;
};

class SlowGather {
 public:
  explicit SlowGather(const GatherSetting& setting) : in_(setting) {}

  [[nodiscard]] GatherPixel pixel(const GatherLayer& layer, std::size_t index, int x, int y) const {
    const RecordedLight& own = (*layer.own)(x, y);
    const double usable = value(own.usable);
    const std::vector<Found> found = frames_at(index, x, y);
    double noise = usable * value(own.noise), pilots = 0.0, matches = 0.0;
    for (const Found& frame : found) {
      noise += frame.match * frame.noise;
      pilots += frame.match * (frame.pilot_variance + value(own.pilot_variance));
      matches += frame.match;
    }
    if (usable + matches > 0.0) noise /= usable + matches;
    if (matches > 0.0) pilots /= matches;
    GatherPixel out{{usable * value(own.r), usable * value(own.g), usable * value(own.b)}, 0.0};
    double total = usable, squares = usable;
    for (std::size_t f = 0; f < found.size(); ++f) {
      if (found[f].match == 0.0) continue;
      const double w = found[f].match * test(layer, index, f, x, y, pilots);
      for (std::size_t c = 0; c < 3; ++c) out.light[c] += w * found[f].light[c];
      total += w, squares += w * w;
    }
    for (double& c : out.light) c /= total;
    out.variance = total > 0.0 ? noise * squares / (total * total) : 0.0;
    return out;
  }

  [[nodiscard]] std::array<double, 3> color(const ColorRecord& own, double width, std::size_t index,
                                            int x, int y) const {
    const std::array<double, 3> here = values(own(x, y));
    std::array<double, 3> sum = here;
    double total = 1.0;
    for (const auto& [step, taps] : steps_at(x, y)) {
      if (taps.empty()) continue;
      std::array<double, 3> there{};
      double usable = 0.0, squares = 0.0, far = 0.0;
      for (const Tap& tap : taps) {
        const PackedColor& from = (*step->colors[index])(tap.x, tap.y);
        if (from.usable == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) there[c] += tap.weight * values(from)[c];
        usable += tap.weight, squares += tap.weight * tap.weight;
      }
      if (usable < 0.5 * total_of(taps)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        there[c] /= usable;
        far += std::pow((there[c] - here[c]) / width, 2.0);
      }
      const double w = std::min(usable, 1.0) * squares / (usable * usable) * slow_falloff(far);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += w * there[c];
      total += w;
    }
    for (double& c : sum) c /= total;
    return sum;
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
  // match: 0 where the frame says nothing.
  struct Found {
    std::array<double, 3> light;
    double pilot, pilot_variance, noise, match;
  };
  struct Seen {
    const GatherStep* step;
    std::vector<Tap> taps;  // none: the pixel is not seen
  };

  [[nodiscard]] static double value(float v) { return static_cast<double>(v); }
  [[nodiscard]] static std::array<double, 3> values(const PackedColor& color) {
    const double step = value(kColorStep);
    return {color.r * step, color.g * step, color.b * step};
  }
  [[nodiscard]] static double slow_falloff(double x) {
    return x < 8.0 ? std::pow(1.0 - x / 8.0, 8.0) : 0.0;
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
        found.push_back({x, y, near * slow_falloff(square)});
      }
    }
    return found;
  }

  [[nodiscard]] static double total_of(const std::vector<Tap>& taps) {
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
    if (known < 0.5 * total_of(taps)) return std::nullopt;
    return Place{place.x + x / known, place.y + y / known, place.log_depth + log_depth / known};
  }

  // The pixel in all frames of all walks.
  [[nodiscard]] std::vector<Seen> steps_at(int x, int y) const {
    std::vector<Seen> seen;
    for (const GatherWalk& walk : in_.walks) {
      Place place{static_cast<double>(x), static_cast<double>(y), 0.0};
      std::vector<Tap> here{{x, y, 1.0}};
      bool is_seen = shows_surface(in_.guides(x, y));
      for (const GatherStep& step : walk) {
        const std::optional<Place> there =
            is_seen ? next(*step.link, here, place) : std::optional<Place>();
        is_seen = there.has_value();
        if (is_seen) {
          place = *there;
          here = taps(*step.guides, in_.guides(x, y), place);
          is_seen = total_of(here) >= value(kLeastMatch);
        }
        seen.push_back({&step, is_seen ? here : std::vector<Tap>()});
      }
    }
    return seen;
  }

  [[nodiscard]] std::vector<Found> frames_at(std::size_t index, int x, int y) const {
    std::vector<Found> found;
    for (const Seen& seen : steps_at(x, y)) {
      found.push_back(light_at(*seen.step->lights[index], seen.taps));
    }
    return found;
  }

  // What a frame says of the pixel, if half of what matches can be used.
  [[nodiscard]] static Found light_at(const LightRecord& record, const std::vector<Tap>& taps) {
    Found sum{};
    if (taps.empty()) return sum;
    for (const Tap& tap : taps) {
      const RecordedLight& from = record(tap.x, tap.y);
      if (from.usable == 0.0f) continue;
      const std::array<float, 3> light{from.r, from.g, from.b};
      for (std::size_t c = 0; c < 3; ++c) sum.light[c] += tap.weight * value(light[c]);
      sum.pilot += tap.weight * value(from.pilot);
      sum.pilot_variance += tap.weight * value(from.pilot_variance);
      sum.noise += tap.weight * value(from.noise);
      sum.match += tap.weight;
    }
    if (sum.match < 0.5 * total_of(taps)) return {};
    for (double& c : sum.light) c /= sum.match;
    sum.pilot /= sum.match, sum.pilot_variance /= sum.match, sum.noise /= sum.match;
    sum.match = std::min(sum.match, 1.0);
    return sum;
  }

  [[nodiscard]] double test(const GatherLayer& layer, std::size_t index, std::size_t frame, int x,
                            int y, double pilots) const {
    double square = 0.0, variance = 0.0, known = 0.0;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        if (!in_.guides.extent().contains(x + dx, y + dy)) continue;
        const RecordedLight& own = (*layer.own)(x + dx, y + dy);
        const Found other = frames_at(index, x + dx, y + dy)[frame];
        if (own.usable == 0.0f || other.match == 0.0) continue;
        const double k = (3.0 - std::abs(dx)) * (3.0 - std::abs(dy));
        const double s = value(own.pilot);
        square += k * std::pow(other.pilot - s, 2.0);
        variance +=
            k *
            (other.pilot_variance + value(own.pilot_variance) +
             std::pow(value(layer.test.tolerance) * std::max(std::abs(other.pilot), std::abs(s)),
                      2.0));
        known += k;
      }
    }
    if (known == 0.0) return 1.0;
    const double ratio = square / (0.5 * (variance + known * pilots));
    return slow_falloff(value(layer.test.slope) * std::max(ratio - value(layer.test.soft), 0.0));
  }

  GatherSetting in_;
};

}  // namespace eigenlight::reference
