#include <algorithm>

#include "frame/strips.h"
#include "temporal/innovation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/innovation_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;

constexpr int kRadius = 4;
constexpr int kWindow = 2 * kRadius + 1;
// Pixels of a row at once: nine rows of their sums (14 kB) stay in the first-level cache.
constexpr int kPart = 128;
// A row of them, what the window reaches on both sides, and what whole vectors read beyond.
constexpr int kWidth = kPart + 2 * kRadius + 64;

// Sums of count, e and e^2: over a row of the window, then over the window.
struct Sums {
  alignas(64) float count[kPart], mean[kPart], square[kPart];
};

// Nine neighbors in four additions: sums of two, of four, of eight, and the ninth. Overwrites the
// values, of which `count` + 8 are meant; reads up to two vectors more.
void SumNine(float* values, int count, float* sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  alignas(64) float pairs[kWidth], fours[kWidth];
  for (int i = 0; i < count + 7; i += lanes) {
    hn::Store(hn::Add(hn::Load(d, values + i), hn::LoadU(d, values + i + 1)), d, pairs + i);
  }
  for (int i = 0; i < count + 5; i += lanes) {
    hn::Store(hn::Add(hn::Load(d, pairs + i), hn::LoadU(d, pairs + i + 2)), d, fours + i);
  }
  for (int i = 0; i < count; i += lanes) {
    const auto eight = hn::Add(hn::Load(d, fours + i), hn::LoadU(d, fours + i + 4));
    hn::Store(hn::Add(eight, hn::LoadU(d, values + i + 8)), d, sums + i);
  }
}

// Horizontal window sums of row y for the pixels of the tile.
void SumRow(const InnovationInputs& in, const Tile& tile, int y, Sums& sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), count = tile.x1 - tile.x0;
  alignas(64) float confirmed[kWidth], value[kWidth], square[kWidth];
  const int first = std::max(tile.x0 - kRadius, 0);
  const int last = std::min(tile.x1 + kRadius, in.residual.width());
  const int shift = first - (tile.x0 - kRadius), end = shift + last - first;
  // Nothing lies to the left and to the right of the image.
  for (int i = 0; i < kRadius; ++i) confirmed[i] = value[i] = square[i] = 0.0f;
  const float* e = in.residual.at(first, y);
  const float* used = in.confirmed.at(first, y);
  const int seen = last - first;
  const auto take = [&](auto tag, int i) {
    const auto v = hn::LoadU(tag, e + i);
    hn::StoreU(hn::LoadU(tag, used + i), tag, confirmed + shift + i);
    hn::StoreU(v, tag, value + shift + i);
    hn::StoreU(hn::Mul(v, v), tag, square + shift + i);
  };
  // The row starts off the lines, so that its padding does not reach to the end of a last vector:
  // that one goes back over what others have taken.
  int i = 0;
  for (; i + lanes <= seen; i += lanes) take(d, i);
  if (i < seen && seen >= lanes) take(d, seen - lanes);
  if (seen < lanes) {
    for (; i < seen; ++i) take(hn::CappedTag<float, 1>(), i);
  }
  for (i = end; i < count + 2 * kRadius; ++i) confirmed[i] = value[i] = square[i] = 0.0f;
  SumNine(confirmed, count, sums.count);
  SumNine(value, count, sums.mean);
  SumNine(square, count, sums.square);
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
  const float tested_share = options.test ? 1.0f : 0.0f;
  const auto larger = [](float a, float b) { return a > b ? a : b; };
  const auto smaller = [](float a, float b) { return a < b ? a : b; };
  for (int i = 0; i < row.x1 - row.x0; ++i) {
    const float age = old_age[i], samples = all_samples[i], count = window.count[i];
    const bool confirmed = all_confirmed[i] > 0.0f, alone = count < 2.0f;
    // Stand-ins keep the arithmetic of pixels finite whose result is not used.
    const float n = confirmed ? age : 1.0f, s = confirmed ? samples : 1.0f;
    const float inverse_count = 1.0f / (alone ? 1.0f : count);
    const float mean = window.mean[i] * inverse_count;
    const float variance = larger(window.square[i] * inverse_count - mean * mean, 0.0f);
    const float noise = variance * inverse_count * (1.0f + 1.0f / n);
    const float excess = tested_share * larger(mean * mean - options.threshold * noise, 0.0f);
    const float history = variance / n + excess;
    const float total = history + variance / s;
    const float weight = total > 0.0f ? history / (total > 0.0f ? total : 1.0f) : s / (n + s);
    // An age below the frame's own samples would weigh them more than once.
    const float max_age = larger(options.max_age, s);
    const float tested = smaller(s / larger(weight, s / (2.0f * max_age)), max_age);
    // Alone there is no spread to test a mean against. A new pixel starts; one without usable
    // sample waits, as it has samples 0.
    const float unconfirmed = smaller(age + samples, larger(options.max_age, samples));
    const float lone = smaller(n + s, max_age);
    new_age[i] = confirmed ? (alone ? lone : tested) : unconfirmed;
    // The memory of the variance is that of the light, but no longer than 16 frames.
    const float step = larger(s / tested, 1.0f / 16.0f);
    const float moved = variances[i] + step * (variance - variances[i]);
    variances[i] = confirmed && !alone ? moved : variances[i];
  }
}

void AddRows(const Sums* const (&rows)[kWindow], int used, int count, Sums& window) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < count; i += lanes) {
    auto n = hn::Load(d, rows[0]->count + i);
    auto mean = hn::Load(d, rows[0]->mean + i), square = hn::Load(d, rows[0]->square + i);
    for (int r = 1; r < used; ++r) {
      n = hn::Add(n, hn::Load(d, rows[r]->count + i));
      mean = hn::Add(mean, hn::Load(d, rows[r]->mean + i));
      square = hn::Add(square, hn::Load(d, rows[r]->square + i));
    }
    hn::Store(n, d, window.count + i);
    hn::Store(mean, d, window.mean + i);
    hn::Store(square, d, window.square + i);
  }
}

void FilterPart(const InnovationInputs& in, const InnovationOptions& options, const Tile& tile,
                const InnovationOutputs& out) {
  // A ring of row sums: each row of the window is summed once.
  Sums ring[kWindow];
  const int height = in.residual.height();
  const auto slot = [](int y) { return y % kWindow; };
  for (int y = std::max(tile.y0 - kRadius, 0); y < std::min(tile.y0 + kRadius, height); ++y) {
    SumRow(in, tile, y, ring[slot(y)]);
  }
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (y + kRadius < height) SumRow(in, tile, y + kRadius, ring[slot(y + kRadius)]);
    const Sums* rows[kWindow] = {};
    int used = 0;
    for (int j = std::max(y - kRadius, 0); j <= std::min(y + kRadius, height - 1); ++j) {
      rows[used++] = &ring[slot(j)];
    }
    Sums window;
    AddRows(rows, used, tile.x1 - tile.x0, window);
    FinishRow(in, options, {tile.x0, y, tile.x1, y + 1, tile.index}, window, out);
  }
}

void InnovationTile(const InnovationInputs& in, const InnovationOptions& options, const Tile& tile,
                    const InnovationOutputs& out) {
  for (int x = tile.x0; x < tile.x1; x += kPart) {
    FilterPart(in, options, {x, tile.y0, std::min(x + kPart, tile.x1), tile.y1, tile.index}, out);
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
  HWY_DYNAMIC_DISPATCH(InnovationTile)(in, options, tile, out);
}

}  // namespace eigenlight
#endif
