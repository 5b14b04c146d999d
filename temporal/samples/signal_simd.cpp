#include <algorithm>
#include <array>

#include "reproject/taps.h"
#include "temporal/bases/tile_sums.h"
#include "temporal/samples/firefly_bound.h"
#include "temporal/samples/signal.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/signal_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Samples granted to a vector of pixels beyond the regular ones.
VF LoadExtra(const SignalInputs& in, int x, int y) {
  return in.extra == nullptr ? Zero() : ConvertTo(F(), LoadBytes(*in.extra, x, y));
}

// The mean of `regular` and `extra` samples.
VF3 LoadMean(const SignalInputs& in, VF regular, VF extra, int x, int y) {
  const MF granted = Gt(extra, Zero());
  const VF scale = Div(Set(1), Add(regular, extra));
  VF3 light;
  for (int c = 0; c < 3; ++c) {
    VF sum = Mul(regular, LoadAndPrefetch(in.raw[c], x, y));
    if (in.extra_mean != nullptr) {
      const VF more = Mul(extra, LoadAndPrefetch((*in.extra_mean)[c], x, y));
      sum = Add(sum, IfThenElseZero(granted, more));
    }
    light[c] = Mul(sum, scale);
  }
  return light;
}

PixelCounts MergeSamples(const SignalInputs& in, const Rect& tile, const SignalOutputs& out) {
  const VF regular = Set(std::max(in.frame.spp, 1)), per_regular = Div(Set(1), regular);
  PixelCounts counts;
  ForEachVector(tile, [&](int x, int y) {
    const VF extra = LoadExtra(in, x, y);
    const VF3 light = LoadMean(in, regular, extra, x, y);
    const VF size = Add(Add(Abs(light[0]), Abs(light[1])), Abs(light[2]));
    prefetch_below(in.frame.surface.id, x, y);
    const MF surface = And(FirstLanes(tile.x1 - x), HasSurface(in.frame.surface.id, x, y));
    const MF usable = And(surface, Le(size, Set(kLargestLight)));  // false for NaN
    const MF fresh = And(surface, Eq(LoadAndPrefetch(in.age, x, y), Zero()));
    for (int c = 0; c < 3; ++c) {
      StoreAndPrefetch(IfThenElse(usable, light[c], NaN()), out.light[c], x, y);
    }
    const VF samples = Mul(Add(regular, extra), per_regular);
    StoreAndPrefetch(IfThenElseZero(usable, samples), out.samples, x, y);
    counts.fresh += CountLanes(fresh);
    counts.non_finite += CountLanes(AndNot(usable, surface));
  });
  return counts;
}

void EstimateVariance(const EstimateInputs& in, const Rect& tile, const EstimateOutputs& out) {
  ForEachVector(tile, [&](int x, int y) {
    const VF age = Load(in.age, x, y);
    const MF known = Gt(age, Zero());
    const VF variance = Div(Load(in.variance, x, y), IfThenElse(known, age, Set(1)));
    StoreAndPrefetch(IfThenElseZero(known, variance), out.variance, x, y);
    prefetch_below(in.id, x, y);
    StoreFlags(And(HasSurface(in.id, x, y), Lt(age, Set(in.young))), out.young, x, y);
  });
}

constexpr int kRadius = 3;
constexpr int kWindow = 2 * kRadius + 1;

// Sums of count, l and l^2: over a row of the window, then over the window.
struct Sums {
  alignas(64) std::array<double, kSegment> count{}, value{}, square{};
};

// Window sums of row y along x for the pixels of the tile.
void SumRow(const FreshInputs& in, const Rect& tile, int y, Sums& sums) {
  alignas(64) double count[kSegment + 2 * kRadius] = {}, value[kSegment + 2 * kRadius] = {};
  const int first = std::max(tile.x0 - kRadius, 0);
  const int last = std::min(tile.x1 + kRadius, in.samples.width());
  const int shift = first - (tile.x0 - kRadius);
  const float* used = in.samples.at(first, y);
  const float* brightness = in.brightness.row(y / kFireflyBlock);
  const float* u[3] = {in.raw[0].at(first, y), in.raw[1].at(first, y), in.raw[2].at(first, y)};
  for (int i = 0; i < last - first; ++i) {
    const bool usable = used[i] > 0.0f;
    const double l = luminance(static_cast<double>(u[0][i]), static_cast<double>(u[1][i]),
                               static_cast<double>(u[2][i]));
    const double most = static_cast<double>(brightness[(first + i) / kFireflyBlock]);
    const double below = l < most ? l : most, bounded = below > -most ? below : -most;
    count[shift + i] = usable ? 1.0 : 0.0;
    value[shift + i] = usable ? bounded : 0.0;
  }
  sums = {};
  for (int j = 0; j < kWindow; ++j) {
    for (int i = 0; i < tile.x1 - tile.x0; ++i) {
      const auto slot = static_cast<std::size_t>(i);
      sums.count[slot] += count[i + j];
      sums.value[slot] += value[i + j];
      sums.square[slot] += value[i + j] * value[i + j];
    }
  }
}

// The new pixels of a tile lie in this part of it; empty without any.
Rect FreshPart(const FrameInput& frame, const Plane<float>& age, const Rect& tile) {
  Rect part{tile.x1, tile.y1, tile.x0, tile.y0};
  for (int y = tile.y0; y < tile.y1; ++y) {
    const float* n = age.row(y);
    const std::uint32_t* id = frame.surface.id.row(y);
    const auto is_fresh = [&](int x) { return (id[x] != 0) & (n[x] == 0.0f); };
    int fresh = 0;
    for (int x = tile.x0; x < tile.x1; ++x) fresh += static_cast<int>(is_fresh(x));
    if (fresh == 0) continue;
    int left = tile.x0, right = tile.x1;
    while (!is_fresh(left)) ++left;
    while (!is_fresh(right - 1)) --right;
    part.x0 = std::min(part.x0, left);
    part.x1 = std::max(part.x1, right);
    part.y0 = std::min(part.y0, y);
    part.y1 = y + 1;
  }
  return part;
}

// Sets the new pixels of a row from the sums of their windows.
void SetFresh(const FreshInputs& in, const Rect& part, int y, const Sums& window,
              Plane<float>& variance) {
  const float* n = in.age.at(part.x0, y);
  const std::uint32_t* id = in.frame.surface.id.at(part.x0, y);
  float* out = variance.at(part.x0, y);
  for (int i = 0; i < part.x1 - part.x0; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double count = window.count[at] > 1.0 ? window.count[at] : 1.0;
    const double mean = window.value[at] / count;
    const double scatter = window.square[at] / count - mean * mean;
    const bool fresh = (id[i] != 0) & (n[i] == 0.0f);
    const bool spread = (window.count[at] > 1.0) & (scatter > 0.0);
    out[i] = fresh ? (spread ? static_cast<float>(scatter) : 0.0f) : out[i];
  }
}

void FreshVariance(const FreshInputs& in, const Rect& tile, Plane<float>& variance) {
  const Rect part = FreshPart(in.frame, in.age, tile);
  if (part.x0 >= part.x1) return;
  // A ring of row sums: each row of the window is summed once.
  std::array<Sums, kWindow> ring;
  const int height = in.samples.height();
  const auto slot = [](int y) { return static_cast<std::size_t>((y + kWindow) % kWindow); };
  const auto fill = [&](int y) {
    if (y < 0 || y >= height) {
      ring[slot(y)] = {};
    } else {
      SumRow(in, part, y, ring[slot(y)]);
    }
  };
  for (int y = part.y0 - kRadius; y < part.y0 + kRadius; ++y) fill(y);
  for (int y = part.y0; y < part.y1; ++y) {
    fill(y + kRadius);
    Sums window;
    for (const Sums& row : ring) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(part.x1 - part.x0); ++i) {
        window.count[i] += row.count[i];
        window.value[i] += row.value[i];
        window.square[i] += row.square[i];
      }
    }
    SetFresh(in, part, y, window, variance);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(MergeSamples);
HWY_EXPORT(EstimateVariance);
HWY_EXPORT(FreshVariance);

PixelCounts merge_samples(const SignalInputs& in, const Rect& tile, const SignalOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  const FloatTrapsOff comparisons_meet_nan;
  return HWY_DYNAMIC_DISPATCH(MergeSamples)(in, tile, out);
}

void estimate_variance(const EstimateInputs& in, const Rect& tile, const EstimateOutputs& out) {
  HWY_DYNAMIC_DISPATCH(EstimateVariance)(in, tile, out);
}

void fresh_variance(const FreshInputs& in, const Rect& tile, Plane<float>& variance) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  const FloatTrapsOff comparisons_meet_nan;
  HWY_DYNAMIC_DISPATCH(FreshVariance)(in, tile, variance);
}

}  // namespace eigenlight
#endif
