#include <algorithm>
#include <array>
#include <limits>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "reproject/taps.h"
#include "temporal/bases/tile_sums.h"
#include "temporal/samples/firefly_bound.h"
#include "temporal/samples/signal.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/signal_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

PixelCounts MergeSamples(const SignalInputs& in, const Rect& tile, const SignalOutputs& out) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const hn::Rebind<std::uint8_t, F> bytes;
  const hn::RebindToSigned<F> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF regular = hn::Set(d, static_cast<float>(std::max(in.frame.spp, 1)));
  const VF zero = hn::Zero(d), per_regular = hn::Div(hn::Set(d, 1.0f), regular);
  const VF nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  PixelCounts counts;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      VF extra = zero;
      if (in.extra != nullptr) {
        extra = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(bytes, in.extra->row(y) + x)));
      }
      const auto granted = hn::Gt(extra, zero);
      const VF samples = hn::Add(regular, extra);
      const VF scale = hn::Div(hn::Set(d, 1.0f), samples);
      VF light[3], size = zero;
      for (std::size_t c = 0; c < 3; ++c) {
        prefetch_below(in.raw[c], x, y);
        prefetch_below(out.light[c], x, y);
        light[c] = hn::Mul(regular, hn::LoadU(d, in.raw[c].row(y) + x));
        if (in.extra_mean != nullptr) {
          prefetch_below((*in.extra_mean)[c], x, y);
          const VF more = hn::Mul(extra, hn::LoadU(d, (*in.extra_mean)[c].row(y) + x));
          light[c] = hn::Add(light[c], hn::IfThenElseZero(granted, more));
        }
        light[c] = hn::Mul(light[c], scale);
        size = hn::Add(size, hn::Abs(light[c]));
      }
      prefetch_below(in.frame.surface.id, x, y);
      prefetch_below(in.age, x, y);
      prefetch_below(out.samples, x, y);
      const auto id = hn::LoadU(du, in.frame.surface.id.row(y) + x);
      const auto inside = hn::FirstN(d, static_cast<std::size_t>(tile.x1 - x));
      const auto surface = hn::And(inside, hn::RebindMask(d, hn::Ne(id, hn::Zero(du))));
      // False of NaN.
      const auto usable = hn::And(surface, hn::Le(size, hn::Set(d, kLargestLight)));
      const auto fresh = hn::And(surface, hn::Eq(hn::LoadU(d, in.age.row(y) + x), zero));
      for (std::size_t c = 0; c < 3; ++c) {
        hn::StoreU(hn::IfThenElse(usable, light[c], nan), d, out.light[c].row(y) + x);
      }
      hn::StoreU(hn::IfThenElseZero(usable, hn::Mul(samples, per_regular)), d,
                 out.samples.row(y) + x);
      counts.fresh += static_cast<std::int64_t>(hn::CountTrue(d, fresh));
      counts.non_finite += static_cast<std::int64_t>(hn::CountTrue(d, hn::AndNot(usable, surface)));
    }
  }
  return counts;
}

void EstimateVariance(const EstimateInputs& in, const Rect& tile, const EstimateOutputs& out) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const hn::Rebind<std::uint8_t, F> bytes;
  const hn::RebindToSigned<F> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      prefetch_below(in.id, x, y);
      prefetch_below(out.variance, x, y);
      const VF age = hn::LoadU(d, in.age.row(y) + x);
      const auto known = hn::Gt(age, zero);
      const VF variance =
          hn::Div(hn::LoadU(d, in.variance.row(y) + x), hn::IfThenElse(known, age, one));
      hn::StoreU(hn::IfThenElseZero(known, variance), d, out.variance.row(y) + x);
      const auto id = hn::LoadU(du, in.id.row(y) + x);
      const auto young =
          hn::And(hn::RebindMask(d, hn::Ne(id, hn::Zero(du))), hn::Lt(age, hn::Set(d, in.young)));
      const auto flag = hn::IfThenElseZero(hn::RebindMask(di, young), hn::Set(di, 1));
      hn::StoreU(hn::DemoteTo(bytes, flag), bytes, out.young.row(y) + x);
    }
  }
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
    const double l = 0.2126 * static_cast<double>(u[0][i]) + 0.7152 * static_cast<double>(u[1][i]) +
                     0.0722 * static_cast<double>(u[2][i]);
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
