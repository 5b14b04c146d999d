#include <algorithm>

#include "reproject/warp.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/warp_simd.cpp"
#include <hwy/foreach_target.h>

#include "reproject/tap_runs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// The weights of a vector of pixels, and for each of the four taps the lanes where it counts.
struct Taps {
  VF weight[4];
  MF counts[4];
};

// Calls warp(run, taps, is_first) for each run of the vector of pixels that starts at number `at`
// of a segment, or empty() if no pixel has taps.
template <typename Warp, typename Empty>
HWY_INLINE void ForEachWarp(const TapSegment& segment, int at, const Warp& warp,
                            const Empty& empty) {
  Taps taps;
  for (int t = 0; t < 4; ++t) taps.weight[t] = Load(F(), segment.weight[t] + at);
  const VF sum = Add(Add(taps.weight[0], taps.weight[1]), Add(taps.weight[2], taps.weight[3]));
  const MF some = Gt(sum, Zero());
  if (AllFalse(F(), some)) return empty();
  bool is_first = true;
  ForEachRun(segment, at, some, [&](const TapRun& run) {
    for (int t = 0; t < 4; ++t) taps.counts[t] = And(run.lanes, Gt(taps.weight[t], Zero()));
    warp(run, taps, is_first);
    is_first = false;
  });
}

// Where the lanes of each tap of a run lie: those up to the end of a block there, the rest in the
// next block.
struct Sources {
  const float* from[8];
  MF counts[8];

  Sources(const BasisField& field, const TapRun& run, const Taps& taps) {
    const int last_x = field.extent().width - 1, last_y = field.extent().height - 1;
    for (int t = 0; t < 4; ++t) {
      const int x = run.x + t % 2, y = std::clamp(run.y + t / 2, 0, last_y);
      // Rounds down also where x is negative.
      const int start = x & ~(kBlock - 1), end = start + kBlock;
      const MF first = Lt(Iota(0), Set(end - x));
      counts[2 * t] = And(first, taps.counts[t]);
      counts[2 * t + 1] = AndNot(first, taps.counts[t]);
      // No lane counts in a block beside the image: any block stands in for it.
      const auto block = [&](int at) { return field.at(at >= 0 && at <= last_x ? at : 0, y); };
      from[2 * t] = block(start) + (x - start);
      from[2 * t + 1] = block(end) - (end - x);
    }
  }
};

// Warps the lanes of a run. If it is the first of its vector, the other lanes become 0.
void WarpBlocks(const BasisField& from, const TapRun& run, const Taps& taps, bool is_first,
                float* to) {
  const F d;
  const Sources sources(from, run, taps);
  for (int j = 0; j < kBlock * from.lines(); j += kBlock) {
    VF sum = is_first ? Zero() : Load(d, to + j), other = Zero();
    const auto term = [&](int s) {
      return IfThenElseZero(sources.counts[s], LoadU(d, sources.from[s] + j));
    };
    for (int t = 0; t < 4; ++t) {
      sum = MulAdd(taps.weight[t], term(2 * t), sum);
      other = MulAdd(taps.weight[t], term(2 * t + 1), other);
    }
    Store(Add(sum, other), d, to + j);
  }
}

void WarpBases(const BasisField& from, const TapSegment& taps, const Rect& row, BasisField& to) {
  ForEachVector(row, [&](int x, int y) {
    float* out = to.at(x, y);
    prefetch_below(to, x, y);
    ForEachWarp(
        taps, x - row.x0,
        [&](const TapRun& run, const Taps& own, bool is_first) {
          prefetch_below(from, run.x, run.y + 1);
          WarpBlocks(from, run, own, is_first, out);
        },
        [&] {
          for (int j = 0; j < to.lines(); ++j) Store(Zero(), F(), out + kBlock * j);
        });
  });
}

// Lanes that do not count may read beside the image.
VF WarpVector(const Plane<float>& from, const TapRun& run, const Taps& taps) {
  const int last = from.height() - 1;
  VF sum = Zero();
  for (int t = 0; t < 4; ++t) {
    const VF value = Load(from, run.x + t % 2, std::clamp(run.y + t / 2, 0, last));
    sum = MulAdd(taps.weight[t], IfThenElseZero(taps.counts[t], value), sum);
  }
  return sum;
}

void WarpPlane(const Plane<float>& from, const TapSegment& taps, const Rect& row,
               Plane<float>& to) {
  const int last = from.height() - 1;
  ForEachVector(row, [&](int x, int y) {
    prefetch_below(to, x, y);
    ForEachWarp(
        taps, x - row.x0,
        [&](const TapRun& run, const Taps& own, bool is_first) {
          prefetch_below(from, run.x, std::clamp(run.y + 1, 0, last));
          const VF sum = WarpVector(from, run, own);
          Store(is_first ? sum : Add(Load(to, x, y), sum), to, x, y);
        },
        [&] { Store(Zero(), to, x, y); });
  });
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
