// Fireflies: they must leave no trail and no block, and keep the energy of the light.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "frame/tiles.h"
#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};
constexpr std::array<float, 3> kSizes{1e2f, 1e4f, 1e6f};
constexpr std::array<double, 3> kRates{1e-5, 1e-3, 1e-2};

struct Fireflies {
  float size;   // times the mean light
  double rate;  // of the samples
  int first, last;

  [[nodiscard]] std::string text() const { return fmt::format("{:g} at {:g}", size, rate); }
};

// In each frame from `first` to `last` a pixel holds a firefly with probability rate * samples; in
// frame `first` pixel (21, 19) always does.
AnalyticOptions with_fireflies(const Fireflies& flies, AnalyticOptions options) {
  options.edit = [flies](Frame& frame) {
    if (frame.index < flies.first || frame.index > flies.last) return;
    const float spp = static_cast<float>(frame.spp);
    for (int y = 0; y < frame.extent().height; ++y) {
      for (int x = 0; x < frame.extent().width; ++x) {
        const float drawn =
            to_unit(hash_key(77u, static_cast<std::uint32_t>(frame.index),
                             static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
        const bool certain = frame.index == flies.first && x == 21 && y == 19;
        if (!certain && static_cast<double>(drawn) >= flies.rate * frame.spp) continue;
        for (auto& plane : frame.lights[0].radiance) plane(x, y) += flies.size / spp;
      }
    }
  };
  return options;
}

// Standard deviation of the mean of a pixel's own samples.
Planes<3> own_noise(const StressRun& run) {
  Planes<3> noise = make_planes<3>(kExtent);
  const float share = 0.5f / std::sqrt(3.0f * static_cast<float>(run.frame().index + 1));
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        noise[static_cast<std::size_t>(c)](x, y) = share * run.truth({x, y}, c);
      }
    }
  }
  return noise;
}

// Four frames with fireflies, then four without. Each firefly changes the mean of a pixel by one
// standard deviation at most: four of them by 4, and chance adds 2.
StressFinding check_trail(StressLog& log) {
  constexpr int kFirst = 12, kLast = 15, kTrail = 4, kFrames = kLast + kTrail + 3;
  const AnalyticOptions options{.extent = kExtent, .frames = kFrames};
  for (const float size : kSizes) {
    for (const double rate : kRates) {
      const Fireflies flies{size, rate, kFirst, kLast};
      StressRun clean(log, options), hit(log, with_fireflies(flies, options));
      while (clean.step() && hit.step()) {
        if (hit.frame().index < kLast + kTrail) continue;
        log.note(largest_deviation(hit.picture(), clean.picture(), own_noise(hit),
                                   [](int, int) { return true; }),
                 flies.text());
      }
    }
  }
  return worst_of(log, 6.0);
}

double mean_of(const Planes<3>& planes, const Rect& tile) {
  double sum = 0.0;
  for (const auto& plane : planes) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) sum += static_cast<double>(plane(x, y));
    }
  }
  return sum / (3.0 * tile.pixels());
}

// Fireflies in all frames: the output lies between the light without them and the light with them.
StressFinding check_energy(StressLog& log) {
  const AnalyticOptions options{.extent = kExtent, .frames = 24};
  const Rect all{0, 0, kExtent.width, kExtent.height};
  for (const float size : kSizes) {
    for (const double rate : kRates) {
      const Fireflies flies{size, rate, 0, options.frames};
      StressRun clean(log, options), hit(log, with_fireflies(flies, options));
      while (clean.step() && hit.step()) {
        if (hit.frame().index < 4) continue;
        const double without = mean_of(clean.picture(), all), found = mean_of(hit.picture(), all);
        const double with = without + rate * static_cast<double>(size);
        log.note(std::max(without - found, found - with) / without, flies.text());
      }
    }
  }
  return worst_of(log, 0.02);
}

// No coefficient tile may become visible during or after the fireflies.
StressFinding check_blocks(StressLog& log) {
  constexpr int kFirst = 12, kLast = 15;
  const AnalyticOptions options{.extent = {96, 96}, .frames = 20};
  const TileGrid grid(options.extent, 32, 32);
  for (const float size : kSizes) {
    const Fireflies flies{size, 1e-5, kFirst, kLast};
    StressRun clean(log, options), hit(log, with_fireflies(flies, options));
    while (clean.step() && hit.step()) {
      for (int i = 0; i < grid.count(); ++i) {
        const double ratio =
            mean_of(hit.picture(), grid.tile(i)) / mean_of(clean.picture(), grid.tile(i));
        log.note(std::abs(ratio - 1.0), flies.text());
      }
    }
  }
  return worst_of(log, 0.02);
}

}  // namespace

std::vector<StressCase> firefly_cases() {
  return {
      {"fireflies.trail",
       "4 frames after the last: difference from a clean run / noise of the pixel's own mean",
       false, check_trail},
      {"fireflies.energy", "share of the mean light lost, or gained beyond the fireflies' energy",
       false, check_energy},
      {"fireflies.blocks", "largest change of the mean of a 32 x 32 tile; invisible at 2 %", false,
       check_blocks}};
}

}  // namespace eigenlight
