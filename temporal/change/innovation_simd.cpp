#include <algorithm>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "frame/strips.h"
#include "temporal/change/innovation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/innovation_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

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
void SumRow(const InnovationInputs& in, const Rect& tile, int y, Sums& sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), count = tile.x1 - tile.x0;
  alignas(64) float confirmed[kWidth], value[kWidth], square[kWidth];
  const int first = std::max(tile.x0 - kRadius, 0);
  const int last = std::min(tile.x1 + kRadius, in.innovation.width());
  const int shift = first - (tile.x0 - kRadius), end = shift + last - first;
  // Nothing lies to the left and to the right of the image.
  for (int i = 0; i < kRadius; ++i) confirmed[i] = value[i] = square[i] = 0.0f;
  const float* innovation = in.innovation.at(first, y);
  const int seen = last - first;
  const auto take = [&](auto tag, int i) {
    prefetch_below(in.innovation, first + i, y);
    const auto e = hn::LoadU(tag, innovation + i);
    const auto missing = hn::IsNaN(e);
    const auto v = hn::IfThenZeroElse(missing, e);
    hn::StoreU(hn::IfThenZeroElse(missing, hn::Set(tag, 1.0f)), tag, confirmed + shift + i);
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

// What a pixel knows of its window, and its age in frames with this one.
struct Found {
  VF variance;  // of one frame
  VF age;
};

// The innovation test. n: frames of history, s: this frame's samples, count >= 2.
Found TestInnovation(const InnovationOptions& options, VF n, VF s, VF count, VF sum, VF square) {
  const F d;
  const VF one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const VF inverse_count = hn::Div(one, count), mean = hn::Mul(sum, inverse_count);
  const VF mean2 = hn::Mul(mean, mean);
  const VF variance = hn::Max(hn::MulSub(square, inverse_count, mean2), zero);
  const VF old = hn::Div(one, n);
  const VF noise = hn::Mul(hn::Mul(variance, inverse_count), hn::Add(one, old));
  VF history = hn::Mul(variance, old);
  if (options.test) {
    const VF bound = hn::Mul(hn::Set(d, options.threshold), noise);
    history = hn::Add(history, hn::Max(hn::Sub(mean2, bound), zero));
  }
  // s / weight, with the weight of this frame history / total; without any noise s / (n + s).
  const VF total = hn::Add(history, hn::Div(variance, s));
  const auto noisy = hn::Gt(total, zero);
  const VF age = hn::Div(hn::IfThenElse(noisy, hn::Mul(s, total), hn::Add(n, s)),
                         hn::IfThenElse(noisy, history, one));
  return {variance, age};
}

// New ages and variances of a row of pixels from their windows.
void FinishRow(const InnovationInputs& in, const InnovationOptions& options, const Rect& row,
               const Sums& window, const InnovationOutputs& out) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const VF longest = hn::Set(d, options.max_age), shortest_step = hn::Set(d, 1.0f / 16.0f);
  for (int i = 0; i < row.x1 - row.x0; i += lanes) {
    const auto load = [&](const Plane<float>& plane) {
      prefetch_below(plane, row.x0 + i, row.y0);
      return hn::LoadU(d, plane.row(row.y0) + row.x0 + i);
    };
    const VF age = load(in.age), samples = load(in.samples), count = hn::Load(d, window.count + i);
    const auto confirmed = hn::Not(hn::IsNaN(load(in.innovation))), alone = hn::Lt(count, two);
    // Stand-ins keep the arithmetic of pixels finite whose result is not used.
    const VF n = hn::IfThenElse(confirmed, age, one), s = hn::IfThenElse(confirmed, samples, one);
    const Found found =
        TestInnovation(options, n, s, hn::IfThenElse(alone, one, count),
                       hn::Load(d, window.mean + i), hn::Load(d, window.square + i));
    // An age below the frame's own samples would weigh them more than once.
    const VF most = hn::Max(longest, s);
    const VF tested = hn::Min(found.age, most);
    // Alone there is no spread to test a mean against. A new pixel starts; one without usable
    // sample waits, as it has samples 0.
    const VF unconfirmed = hn::Min(hn::Add(age, samples), hn::Max(longest, samples));
    const VF lone = hn::Min(hn::Add(n, s), most);
    hn::StoreU(hn::IfThenElse(confirmed, hn::IfThenElse(alone, lone, tested), unconfirmed), d,
               out.age.row(row.y0) + row.x0 + i);
    // The memory of the variance is that of the light, but no longer than 16 frames.
    const VF step = hn::Max(hn::Div(s, tested), shortest_step);
    prefetch_below(out.variance, row.x0 + i, row.y0);
    float* variances = out.variance.row(row.y0) + row.x0 + i;
    const VF before = hn::LoadU(d, variances);
    const VF moved = hn::MulAdd(step, hn::Sub(found.variance, before), before);
    hn::StoreU(hn::IfThenElse(hn::AndNot(alone, confirmed), moved, before), d, variances);
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

void FilterPart(const InnovationInputs& in, const InnovationOptions& options, const Rect& tile,
                const InnovationOutputs& out) {
  // A ring of row sums: each row of the window is summed once.
  Sums ring[kWindow];
  const int height = in.innovation.height();
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
    FinishRow(in, options, {tile.x0, y, tile.x1, y + 1}, window, out);
  }
}

void InnovationTile(const InnovationInputs& in, const InnovationOptions& options, const Rect& tile,
                    const InnovationOutputs& out) {
  for (int x = tile.x0; x < tile.x1; x += kPart) {
    FilterPart(in, options, {x, tile.y0, std::min(x + kPart, tile.x1), tile.y1}, out);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(InnovationTile);

void innovation_tile(const InnovationInputs& in, const InnovationOptions& options, const Rect& tile,
                     const InnovationOutputs& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(InnovationTile)(in, options, tile, out);
}

}  // namespace eigenlight
#endif
