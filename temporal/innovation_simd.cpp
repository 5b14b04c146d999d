#include <algorithm>
#include <array>

#include "reproject/taps.h"
#include "temporal/innovation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/innovation_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr int kRadius = 4;
constexpr int kWidth = kSegment + 2 * kRadius;
constexpr int kRows = 2 * kRadius + 1;

// Sums of count, e and e^2: over a row of the window, then over the window.
struct Sums {
  alignas(64) std::array<float, kSegment> count{}, mean{}, square{};
};

// Horizontal window sums of row y for the pixels of the tile.
void SumRow(const InnovationInputs& in, const Tile& tile, int y, Sums& sums) {
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

// New ages and variances of a row of pixels from their windows. Written without branches, so that
// the loop becomes vectors.
void FinishRow(const InnovationInputs& in, const InnovationOptions& options, const Tile& row,
               const Sums& window, const InnovationOutputs& out) {
  const float* old_age = in.age.at(row.x0, row.y0);
  const float* all_samples = in.samples.at(row.x0, row.y0);
  const float* all_confirmed = in.confirmed.at(row.x0, row.y0);
  float* new_age = out.age.at(row.x0, row.y0);
  float* variances = out.variance.at(row.x0, row.y0);
  const auto larger = [](float a, float b) { return a > b ? a : b; };
  const auto smaller = [](float a, float b) { return a < b ? a : b; };
  for (int i = 0; i < row.x1 - row.x0; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    const float age = old_age[i], samples = all_samples[i], count = window.count[slot];
    const bool confirmed = all_confirmed[i] > 0.0f, alone = count < 2.0f;
    // Stand-ins keep the arithmetic of pixels finite whose result is not used.
    const float n = confirmed ? age : 1.0f, s = confirmed ? samples : 1.0f;
    const float inverse_count = 1.0f / (alone ? 1.0f : count);
    const float mean = window.mean[slot] * inverse_count;
    const float variance = larger(window.square[slot] * inverse_count - mean * mean, 0.0f);
    const float noise = variance * inverse_count * (1.0f + 1.0f / n);
    const float excess = larger(mean * mean - options.threshold * noise, 0.0f);
    const float history = variance / n + excess;
    const float total = history + variance / s;
    const float weight = total > 0.0f ? history / (total > 0.0f ? total : 1.0f) : s / (n + s);
    // An age below the frame's own samples would weigh them more than once.
    const float max_age = larger(options.max_age, s);
    const float tested = smaller(s / larger(weight, s / (2.0f * max_age)), max_age);
    // Alone there is no spread to test a mean against. A new pixel starts; one without usable
    // sample waits.
    const float unconfirmed = age > 0.0f ? age : samples;
    const float lone = smaller(n + s, max_age);
    new_age[i] = confirmed ? (alone ? lone : tested) : unconfirmed;
    const float step = larger(1.0f / (n + 1.0f), 1.0f / 16.0f);
    const float moved = variances[i] + step * (variance - variances[i]);
    variances[i] = confirmed && !alone ? moved : variances[i];
  }
}

void InnovationTile(const InnovationInputs& in, const InnovationOptions& options, const Tile& tile,
                    const InnovationOutputs& out) {
  // A ring of row sums: each row of the window is summed once.
  std::array<Sums, kRows> ring{};
  const int height = in.residual.height();
  const auto width = static_cast<std::size_t>(tile.x1 - tile.x0);
  const auto slot = [](int y) { return static_cast<std::size_t>((y + kRows) % kRows); };
  for (int y = std::max(tile.y0 - kRadius, 0); y < std::min(tile.y0 + kRadius, height); ++y) {
    SumRow(in, tile, y, ring[slot(y)]);
  }
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (y + kRadius < height) {
      SumRow(in, tile, y + kRadius, ring[slot(y + kRadius)]);
    } else {
      ring[slot(y + kRadius)] = {};
    }
    Sums window;
    for (const Sums& row : ring) {
      for (std::size_t i = 0; i < width; ++i) {
        window.count[i] += row.count[i];
        window.mean[i] += row.mean[i];
        window.square[i] += row.square[i];
      }
    }
    FinishRow(in, options, {tile.x0, y, tile.x1, y + 1, tile.index}, window, out);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(InnovationTile);

void innovation_tile(const InnovationInputs& in, const InnovationOptions& options, const Tile& tile,
                     const InnovationOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(InnovationTile)(in, options, tile, out);
}

}  // namespace eigenlight
#endif
