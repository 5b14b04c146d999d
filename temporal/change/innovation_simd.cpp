#include <algorithm>

#include "frame/strips.h"
#include "temporal/change/innovation.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/change/innovation_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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
  const int lanes = LaneCount();
  alignas(64) float pairs[kWidth], fours[kWidth];
  for (int i = 0; i < count + 7; i += lanes) {
    Store(Add(Load(d, values + i), LoadU(d, values + i + 1)), d, pairs + i);
  }
  for (int i = 0; i < count + 5; i += lanes) {
    Store(Add(Load(d, pairs + i), LoadU(d, pairs + i + 2)), d, fours + i);
  }
  for (int i = 0; i < count; i += lanes) {
    const auto eight = Add(Load(d, fours + i), LoadU(d, fours + i + 4));
    Store(Add(eight, LoadU(d, values + i + 8)), d, sums + i);
  }
}

// Horizontal window sums of row y for the pixels of the tile.
void SumRow(const InnovationInputs& in, const Rect& tile, int y, Sums& sums) {
  const F d;
  const int lanes = LaneCount(), count = tile.x1 - tile.x0;
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
    const auto e = LoadU(tag, innovation + i);
    const auto missing = IsNaN(e);
    const auto v = IfThenZeroElse(missing, e);
    StoreU(IfThenZeroElse(missing, Set(tag, 1.0f)), tag, confirmed + shift + i);
    StoreU(v, tag, value + shift + i);
    StoreU(Mul(v, v), tag, square + shift + i);
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
  const VF one = Set(1.0f), zero = Zero();
  const VF inverse_count = Div(one, count), mean = Mul(sum, inverse_count);
  const VF mean2 = Mul(mean, mean);
  const VF variance = Max(MulSub(square, inverse_count, mean2), zero);
  const VF old = Div(one, n);
  const VF noise = Mul(Mul(variance, inverse_count), Add(one, old));
  VF history = Mul(variance, old);
  if (options.test) {
    const VF bound = Mul(Set(options.threshold), noise);
    history = Add(history, Max(Sub(mean2, bound), zero));
  }
  // s / weight, with the weight of this frame history / total; without any noise s / (n + s).
  const VF total = Add(history, Div(variance, s));
  const auto noisy = Gt(total, zero);
  const VF age = Div(IfThenElse(noisy, Mul(s, total), Add(n, s)), IfThenElse(noisy, history, one));
  return {variance, age};
}

// New ages and variances of a row of pixels from their windows.
void FinishRow(const InnovationInputs& in, const InnovationOptions& options, const Rect& row,
               const Sums& window, const InnovationOutputs& out) {
  const F d;
  const int y = row.y0;
  const VF one = Set(1), longest = Set(options.max_age);
  for (int i = 0; i < row.x1 - row.x0; i += LaneCount()) {
    const int x = row.x0 + i;
    const VF age = LoadAndPrefetch(in.age, x, y), samples = LoadAndPrefetch(in.samples, x, y);
    const VF count = Load(d, window.count + i);
    const MF confirmed = Not(IsNaN(LoadAndPrefetch(in.innovation, x, y)));
    const MF alone = Lt(count, Set(2));
    // Stand-ins keep the arithmetic of pixels finite whose result is not used.
    const VF n = IfThenElse(confirmed, age, one), s = IfThenElse(confirmed, samples, one);
    const Found found = TestInnovation(options, n, s, IfThenElse(alone, one, count),
                                       Load(d, window.mean + i), Load(d, window.square + i));
    // An age below the frame's own samples would weigh them more than once.
    const VF most = Max(longest, s);
    const VF tested = Min(found.age, most);
    // Without neighbors there is no spread to test a mean against. A new pixel starts; one without
    // a usable sample has samples 0 and so keeps its age.
    const VF unconfirmed = Min(Add(age, samples), Max(longest, samples));
    const VF lone = Min(Add(n, s), most);
    Store(IfThenElse(confirmed, IfThenElse(alone, lone, tested), unconfirmed), out.age, x, y);
    // The variance remembers as long as the light does, but at most 16 frames.
    const VF step = Max(Div(s, tested), Set(1.0f / 16.0f));
    const VF before = LoadAndPrefetch(out.variance, x, y);
    const VF moved = MulAdd(step, Sub(found.variance, before), before);
    Store(IfThenElse(AndNot(alone, confirmed), moved, before), out.variance, x, y);
  }
}

void AddRows(const Sums* const (&rows)[kWindow], int used, int count, Sums& window) {
  const F d;
  const int lanes = LaneCount();
  for (int i = 0; i < count; i += lanes) {
    auto n = Load(d, rows[0]->count + i);
    auto mean = Load(d, rows[0]->mean + i), square = Load(d, rows[0]->square + i);
    for (int r = 1; r < used; ++r) {
      n = Add(n, Load(d, rows[r]->count + i));
      mean = Add(mean, Load(d, rows[r]->mean + i));
      square = Add(square, Load(d, rows[r]->square + i));
    }
    Store(n, d, window.count + i);
    Store(mean, d, window.mean + i);
    Store(square, d, window.square + i);
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
