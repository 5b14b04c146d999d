#include "temporal/innovation.h"

#include <algorithm>
#include <array>

#include "reproject/taps.h"

namespace eigenlight {
namespace {

constexpr int kRadius = 4;
constexpr int kWidth = kSegment + 2 * kRadius;
constexpr int kRows = 2 * kRadius + 1;

// Sums of count, e and e^2: over a row of the window, then over the window.
struct Sums {
  alignas(64) std::array<float, kSegment> count{}, mean{}, square{};
};

// Horizontal window sums of row y for the pixels of the tile.
void sum_row(const InnovationInputs& in, const Tile& tile, int y, Sums& sums) {
  std::array<float, kWidth> count{}, value{};
  const int first = std::max(tile.x0 - kRadius, 0);
  const int last = std::min(tile.x1 + kRadius, in.residual.width());
  const auto shift = static_cast<std::size_t>(first - (tile.x0 - kRadius));
  std::copy(in.confirmed.at(first, y), in.confirmed.row(y) + last, count.begin() + shift);
  std::copy(in.residual.at(first, y), in.residual.row(y) + last, value.begin() + shift);
  sums = {};
  const auto width = static_cast<std::size_t>(tile.x1 - tile.x0);
  for (std::size_t j = 0; j < kRows; ++j) {
    for (std::size_t i = 0; i < width; ++i) {
      sums.count[i] += count[i + j];
      sums.mean[i] += value[i + j];
      sums.square[i] += value[i + j] * value[i + j];
    }
  }
}

// New age and variance of one pixel from its window.
void finish_pixel(const InnovationInputs& in, const InnovationOptions& options, int x, int y,
                  float count, float sum, float square, const InnovationOutputs& out) {
  const float age = in.age(x, y), samples = in.samples(x, y);
  const bool confirmed = in.confirmed(x, y) > 0.0f;
  if (!confirmed) {
    // A new pixel starts; a pixel whose sample is unusable waits.
    out.age(x, y) = age > 0.0f ? age : samples;
    return;
  }
  // An age below the frame's own samples would weigh them more than once.
  const float max_age = std::max(options.max_age, samples);
  if (count < 2.0f) {  // alone: no spread to test a mean against
    out.age(x, y) = std::min(age + samples, max_age);
    return;
  }
  const float mean = sum / count;
  const float variance = std::max(square / count - mean * mean, 0.0f);
  const float noise = variance / count * (1.0f + 1.0f / age);
  const float excess = std::max(mean * mean - options.threshold * noise, 0.0f);
  const float history = variance / age + excess;
  const float fresh = variance / samples;
  const float total = history + fresh;
  const float weight = total > 0.0f ? history / total : samples / (age + samples);
  out.age(x, y) = std::min(samples / std::max(weight, samples / (2.0f * max_age)), max_age);
  const float step = std::max(1.0f / (age + 1.0f), 1.0f / 16.0f);
  out.variance(x, y) += step * (variance - out.variance(x, y));
}

}  // namespace

void InnovationOptions::validate() const {
  EL_CHECK(threshold >= 0.0f && threshold <= 100.0f, "threshold {}: expected [0, 100]", threshold);
  EL_CHECK(max_age >= 1.0f && max_age <= 255.0f, "max_age {}: expected [1, 255] frames", max_age);
}

void innovation_tile(const InnovationInputs& in, const InnovationOptions& options, const Tile& tile,
                     const InnovationOutputs& out) {
  // A ring of row sums: each row of the window is summed once.
  std::array<Sums, kRows> ring{};
  const int height = in.residual.height();
  const auto slot = [](int y) { return static_cast<std::size_t>((y + kRows) % kRows); };
  for (int y = std::max(tile.y0 - kRadius, 0); y < std::min(tile.y0 + kRadius, height); ++y) {
    sum_row(in, tile, y, ring[slot(y)]);
  }
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (y + kRadius < height) {
      sum_row(in, tile, y + kRadius, ring[slot(y + kRadius)]);
    } else {
      ring[slot(y + kRadius)] = {};
    }
    Sums window;
    for (const Sums& row : ring) {
      for (std::size_t i = 0; i < kSegment; ++i) {
        window.count[i] += row.count[i];
        window.mean[i] += row.mean[i];
        window.square[i] += row.square[i];
      }
    }
    for (int x = tile.x0; x < tile.x1; ++x) {
      const auto i = static_cast<std::size_t>(x - tile.x0);
      finish_pixel(in, options, x, y, window.count[i], window.mean[i], window.square[i], out);
    }
  }
}

}  // namespace eigenlight
