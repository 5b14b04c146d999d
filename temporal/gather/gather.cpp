#include "temporal/gather/gather.h"

#include <array>
#include <cmath>
#include <limits>

#include "frame/check.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

// Below the square of any light that can be seen.
constexpr float kTiny = 1e-12f;
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kTile = 32;
// Pixels around a tile that its tests read.
constexpr int kAround = 2;
constexpr std::array<float, 5> kTent{1.0f, 2.0f, 3.0f, 2.0f, 1.0f};

// What a frame's pilots say of a pixel. match: 0 where the frame says nothing.
struct Candidate {
  float pilot, pilot_variance, noise, match;
};

Candidate find_candidate(const LightRecord& record, const FrameTaps& taps) {
  Candidate sum{};
  if (taps.total == 0.0f) return sum;
  each_tap(taps, [&](int x, int y, float weight) {
    const RecordedLight& from = record(x, y);
    sum.pilot += weight * from.pilot;
    sum.pilot_variance += weight * from.pilot_variance;
    sum.noise += weight * from.noise;
    sum.match += weight * from.usable;
  });
  if (sum.match < 0.5f * taps.total) return {};
  const float over = 1.0f / sum.match;
  return {sum.pilot * over, sum.pilot_variance * over, sum.noise * over, std::min(sum.match, 1.0f)};
}

// Terms of a test, and the weight of their window that is known.
struct Terms {
  float square, variance, known;
};

Terms terms_of(const RecordedLight& own, const Candidate& other, float tolerance) {
  if (own.usable == 0.0f || other.match == 0.0f) return {};
  const float d = other.pilot - own.pilot;
  const float drift = tolerance * std::max(std::abs(other.pilot), std::abs(own.pilot));
  return {d * d, other.pilot_variance + own.pilot_variance + drift * drift, 1.0f};
}

// Sums of the light of a pixel, and of weights and their squares.
struct LightSum {
  float r, g, b, total, squares, noise, pilots;
};

// One tile and the frames around it.
class TileGather {
 public:
  TileGather(const Plane<PackedGuide>& guides, const GuideWidths& widths,
             std::span<const GatherWalk> walks, const Rect& tile)
      : guides_(guides), tile_(tile) {
    const Extent extent = guides.extent();
    area_ = {std::max(tile.x0 - kAround, 0), std::max(tile.y0 - kAround, 0),
             std::min(tile.x1 + kAround, extent.width), std::min(tile.y1 + kAround, extent.height)};
    places_.find(area_, guides, widths, walks);
  }

  void light(const GatherLayer& layer, std::size_t index) {
    find_candidates(index);
    start(layer);
    for (std::size_t f = 0; f < places_.frames(); ++f) {
      find_windows(layer, f);
      add_light(*places_.step(f).lights[index], layer.test, f);
    }
    finish(layer);
  }

  void color(const GatherColor& color, std::size_t index) const {
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int x = tile_.x0; x < tile_.x1; ++x) steady(color, index, x, y);
    }
  }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>((y - area_.y0) * area_.width() + x - area_.x0);
  }
  [[nodiscard]] const Candidate& candidate(std::size_t frame, std::size_t pixel) const {
    return candidates_[frame * static_cast<std::size_t>(area_.pixels()) + pixel];
  }
  template <typename Visit>
  void each_pixel(const Visit& visit) const {
    std::size_t i = 0;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int x = tile_.x0; x < tile_.x1; ++x) visit(x, y, i++);
    }
  }

  void find_candidates(std::size_t index) {
    candidates_.clear();
    for (std::size_t f = 0; f < places_.frames(); ++f) {
      const LightRecord& record = *places_.step(f).lights[index];
      for (const FrameTaps& taps : places_.taps(f)) {
        candidates_.push_back(find_candidate(record, taps));
      }
    }
  }

  // The frame's own light, and means over all frames.
  void start(const GatherLayer& layer) {
    sums_.assign(static_cast<std::size_t>(tile_.pixels()), LightSum{});
    each_pixel([&](int x, int y, std::size_t i) {
      const RecordedLight& own = (*layer.own)(x, y);
      LightSum& sum = sums_[i];
      sum = {own.r, own.g, own.b, own.usable, own.usable, own.usable * own.noise, 0.0f};
      float matches = 0.0f;
      for (std::size_t f = 0; f < places_.frames(); ++f) {
        const Candidate& other = candidate(f, at(x, y));
        sum.noise += other.match * other.noise;
        sum.pilots += other.match * (other.pilot_variance + own.pilot_variance);
        matches += other.match;
      }
      sum.noise /= std::max(own.usable + matches, kTiny);
      sum.pilots /= std::max(matches, kTiny);
    });
  }

  // Sums of the terms of a test over windows, row by row and then column by column.
  void find_windows(const GatherLayer& layer, std::size_t frame) {
    const int width = area_.width();
    terms_.resize(static_cast<std::size_t>(area_.pixels()));
    rows_.assign(terms_.size(), Terms{});
    for (int y = area_.y0; y < area_.y1; ++y) {
      for (int x = area_.x0; x < area_.x1; ++x) {
        terms_[at(x, y)] =
            terms_of((*layer.own)(x, y), candidate(frame, at(x, y)), layer.test.tolerance);
      }
      const Terms* row = &terms_[at(area_.x0, y)];
      for (int x = tile_.x0 - area_.x0; x < tile_.x1 - area_.x0; ++x) {
        Terms& sum = rows_[at(area_.x0, y) + static_cast<std::size_t>(x)];
        for (int d = -kAround; d <= kAround; ++d) {
          if (x + d >= 0 && x + d < width) add(row[x + d], d, sum);
        }
      }
    }
    windows_.assign(sums_.size(), Terms{});
    each_pixel([&](int x, int y, std::size_t i) {
      for (int d = -kAround; d <= kAround; ++d) {
        if (y + d >= area_.y0 && y + d < area_.y1) add(rows_[at(x, y + d)], d, windows_[i]);
      }
    });
  }

  static void add(const Terms& term, int distance, Terms& sum) {
    const float k = kTent[static_cast<std::size_t>(distance + kAround)];
    sum.square += k * term.square;
    sum.variance += k * term.variance;
    sum.known += k * term.known;
  }

  // How well a frame says the same as the frame at hand.
  [[nodiscard]] static float weight(const LightTest& test, const Terms& window, float pilots) {
    if (window.known == 0.0f) return 1.0f;
    const float variance = 0.5f * (window.variance + window.known * pilots);
    const float ratio = window.square / (variance + kTiny);
    return falloff(test.slope * std::max(0.0f, ratio - test.soft));
  }

  void add_light(const LightRecord& record, const LightTest& test, std::size_t frame) {
    const std::span<const FrameTaps> all = places_.taps(frame);
    each_pixel([&](int x, int y, std::size_t i) {
      const Candidate& other = candidate(frame, at(x, y));
      if (other.match == 0.0f) return;
      LightSum& sum = sums_[i];
      const float w = other.match * weight(test, windows_[i], sum.pilots);
      if (w == 0.0f) return;
      float r = 0.0f, g = 0.0f, b = 0.0f, usable = 0.0f;
      each_tap(all[at(x, y)], [&](int tx, int ty, float weight) {
        const RecordedLight& from = record(tx, ty);
        r += weight * from.r, g += weight * from.g, b += weight * from.b;
        usable += weight * from.usable;
      });
      const float over = w / usable;
      sum.r += over * r, sum.g += over * g, sum.b += over * b;
      sum.total += w, sum.squares += w * w;
    });
  }

  void finish(const GatherLayer& layer) const {
    each_pixel([&](int x, int y, std::size_t i) {
      const LightSum& sum = sums_[i];
      const float over = sum.total > 0.0f ? 1.0f / sum.total : kNone;
      Planes<3>& light = *layer.light;
      light[0](x, y) = sum.r * over;
      light[1](x, y) = sum.g * over;
      light[2](x, y) = sum.b * over;
      (*layer.variance)(x, y) = sum.total > 0.0f ? sum.noise * sum.squares * over * over : 0.0f;
    });
  }

  void steady(const GatherColor& color, std::size_t index, int x, int y) const {
    const PackedColor& own = (*color.own)(x, y);
    if (own.usable == 0) {
      for (auto& plane : *color.color) plane(x, y) = kNone;
      return;
    }
    const std::size_t frames = own.usable == kCertainColor ? 0 : places_.frames();
    std::array<float, 3> sum{static_cast<float>(own.r), static_cast<float>(own.g),
                             static_cast<float>(own.b)};
    float total = 1.0f;
    for (std::size_t f = 0; f < frames; ++f) {
      const FrameTaps& taps = places_.taps(f)[at(x, y)];
      if (taps.total == 0.0f) continue;
      const ColorRecord& record = *places_.step(f).colors[index];
      float r = 0.0f, g = 0.0f, b = 0.0f, usable = 0.0f, squares = 0.0f;
      each_tap(taps, [&](int tx, int ty, float weight) {
        const PackedColor& from = record(tx, ty);
        const float w = from.usable != 0 ? weight : 0.0f;
        r += w * static_cast<float>(from.r);
        g += w * static_cast<float>(from.g);
        b += w * static_cast<float>(from.b);
        usable += w;
        squares += w * w;
      });
      if (usable < 0.5f * taps.total) continue;
      const float over = 1.0f / usable;
      r *= over, g *= over, b *= over;
      const float dr = r - static_cast<float>(own.r), dg = g - static_cast<float>(own.g),
                  db = b - static_cast<float>(own.b);
      const float width = color.width / kColorStep;
      const float w = std::min(usable, 1.0f) * squares * over * over *
                      falloff((dr * dr + dg * dg + db * db) / (width * width));
      sum[0] += w * r, sum[1] += w * g, sum[2] += w * b;
      total += w;
    }
    for (std::size_t c = 0; c < 3; ++c) (*color.color)[c](x, y) = sum[c] * kColorStep / total;
  }

  const Plane<PackedGuide>& guides_;
  Rect tile_, area_;
  FramePlaces places_;
  std::vector<Candidate> candidates_;
  std::vector<LightSum> sums_;
  std::vector<Terms> terms_, rows_, windows_;
};

}  // namespace

void LightTest::validate() const {
  EL_CHECK(tolerance >= 0.0f && tolerance <= 1.0f, "tolerance {}: expected [0, 1]", tolerance);
  EL_CHECK(soft >= 0.0f && soft <= 100.0f, "soft {}: expected [0, 100]", soft);
  EL_CHECK(slope >= 0.0f && slope <= 100.0f, "slope {}: expected [0, 100]", slope);
}

void gather(const Plane<PackedGuide>& guides, const GuideWidths& widths,
            std::span<const GatherWalk> walks, std::span<const GatherLayer> layers,
            std::span<const GatherColor> colors) {
  const TileGrid grid(guides.extent(), kTile, kTile);
  parallel_for(grid.count(), [&](int index) {
    TileGather tile(guides, widths, walks, grid.tile(index));
    for (std::size_t i = 0; i < layers.size(); ++i) tile.light(layers[i], i);
    for (std::size_t i = 0; i < colors.size(); ++i) tile.color(colors[i], i);
  });
}

}  // namespace eigenlight
