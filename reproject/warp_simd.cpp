#include <algorithm>

#include "frame/prefetch.h"
#include "reproject/warp.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/warp_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using MF = hn::Mask<F>;

// Pixels of a vector whose taps stand side by side, the upper left one of lane i at (x + i, y): of
// each tap those where it counts.
struct Run {
  int x, y;
  MF counts[4];
};

// Takes the run of the first of the lanes that are `left` from them.
Run TakeRun(const TapSegment& taps, std::size_t at, const VF (&weight)[4], MF& left) {
  const F d;
  const I di;
  const std::size_t first = hn::FindKnownFirstTrue(d, left);
  Run run{taps.x[at + first] - static_cast<int>(first), taps.y[at + first], {}};
  const VI x = hn::Sub(hn::Load(di, taps.x.data() + at), hn::Iota(di, 0));
  const VI y = hn::Load(di, taps.y.data() + at);
  const auto same = hn::And(hn::Eq(x, hn::Set(di, run.x)), hn::Eq(y, hn::Set(di, run.y)));
  const MF lanes = hn::And(left, hn::RebindMask(d, same));
  for (int t = 0; t < 4; ++t) run.counts[t] = hn::And(lanes, hn::Gt(weight[t], hn::Zero(d)));
  left = hn::AndNot(lanes, left);
  return run;
}

// Calls warp(run, is_first) for each run of the vector of pixels `at` a segment; none if no pixel
// has taps, which is for `empty`.
template <typename Warp, typename Empty>
void ForEachRun(const TapSegment& taps, std::size_t at, const Warp& warp, const Empty& empty) {
  const F d;
  VF weight[4];
  for (std::size_t t = 0; t < 4; ++t) weight[t] = hn::Load(d, taps.weight[t].data() + at);
  MF left =
      hn::Gt(hn::Add(hn::Add(weight[0], weight[1]), hn::Add(weight[2], weight[3])), hn::Zero(d));
  if (hn::AllFalse(d, left)) return empty();
  for (bool is_first = true; !hn::AllFalse(d, left); is_first = false) {
    warp(TakeRun(taps, at, weight, left), weight, is_first);
  }
}

// What a tap of a run takes from two blocks: the lanes up to the end of one, the rest from the
// next.
struct Terms {
  const float* from[8];
  MF counts[8];

  Terms(const BasisField& field, const Run& run) {
    const F d;
    const int last_x = field.extent().width - 1, last_y = field.extent().height - 1;
    const VF lane = hn::Iota(d, 0.0f);
    for (int t = 0; t < 4; ++t) {
      const int x = run.x + t % 2, y = std::clamp(run.y + t / 2, 0, last_y);
      // Rounds down also where x is negative.
      const int start = x & ~(kBlock - 1), end = start + kBlock;
      const MF first = hn::Lt(lane, hn::Set(d, static_cast<float>(end - x)));
      counts[2 * t] = hn::And(first, run.counts[t]);
      counts[2 * t + 1] = hn::AndNot(first, run.counts[t]);
      // Nothing counts in blocks beside the image: any other will do.
      const auto block = [&](int at) { return field.at(at >= 0 && at <= last_x ? at : 0, y); };
      from[2 * t] = block(start) + (x - start);
      from[2 * t + 1] = block(end) - (end - x);
    }
  }
};

// Of the pixels from x on, those of a run; the others get 0 if it is the first.
void WarpBlocks(const BasisField& from, const Run& run, const VF (&weights)[4], bool is_first,
                float* to) {
  const F d;
  const Terms terms(from, run);
  for (int j = 0; j < kBlock * from.lines(); j += kBlock) {
    VF sum = is_first ? hn::Zero(d) : hn::Load(d, to + j), other = hn::Zero(d);
    const auto term = [&](int t) {
      return hn::IfThenElseZero(terms.counts[t], hn::LoadU(d, terms.from[t] + j));
    };
    for (int t = 0; t < 4; ++t) {
      sum = hn::MulAdd(weights[t], term(2 * t), sum);
      other = hn::MulAdd(weights[t], term(2 * t + 1), other);
    }
    hn::Store(hn::Add(sum, other), d, to + j);
  }
}

void WarpBases(const BasisField& from, const TapSegment& taps, const Rect& row, BasisField& to) {
  const F d;
  for (int x = row.x0; x < row.x1; x += static_cast<int>(hn::Lanes(d))) {
    float* out = to.at(x, row.y0);
    prefetch_below(to, x, row.y0);
    ForEachRun(
        taps, static_cast<std::size_t>(x - row.x0),
        [&](const Run& run, const VF(&weights)[4], bool is_first) {
          prefetch_below(from, run.x, run.y + 1);
          WarpBlocks(from, run, weights, is_first, out);
        },
        [&] {
          for (int j = 0; j < to.lines(); ++j) hn::Store(hn::Zero(d), d, out + kBlock * j);
        });
  }
}

// What lanes that do not count load, which may lie beside the image, is left out.
VF WarpVector(const Plane<float>& from, const Run& run, const VF (&weights)[4]) {
  const F d;
  const int last = from.height() - 1;
  VF sum = hn::Zero(d);
  for (int t = 0; t < 4; ++t) {
    const float* row = from.row(std::clamp(run.y + t / 2, 0, last));
    const VF value = hn::LoadU(d, row + run.x + t % 2);
    sum = hn::MulAdd(weights[t], hn::IfThenElseZero(run.counts[t], value), sum);
  }
  return sum;
}

void WarpPlane(const Plane<float>& from, const TapSegment& taps, const Rect& row,
               Plane<float>& to) {
  const F d;
  const int last = from.height() - 1;
  for (int x = row.x0; x < row.x1; x += static_cast<int>(hn::Lanes(d))) {
    float* out = to.at(x, row.y0);
    prefetch_below(to, x, row.y0);
    ForEachRun(
        taps, static_cast<std::size_t>(x - row.x0),
        [&](const Run& run, const VF(&weights)[4], bool is_first) {
          prefetch_below(from, run.x, std::clamp(run.y + 1, 0, last));
          const VF sum = WarpVector(from, run, weights);
          hn::Store(is_first ? sum : hn::Add(hn::Load(d, out), sum), d, out);
        },
        [&] { hn::Store(hn::Zero(d), d, out); });
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(WarpBases);
HWY_EXPORT(WarpPlane);

void warp_bases(const BasisField& from, const TapSegment& taps, const Rect& row, BasisField& to) {
  EL_DCHECK(from.bases() == to.bases() && row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(WarpBases)(from, taps, row, to);
}

void warp_plane(const Plane<float>& from, const TapSegment& taps, const Rect& row,
                Plane<float>& to) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(WarpPlane)(from, taps, row, to);
}

}  // namespace eigenlight
#endif
