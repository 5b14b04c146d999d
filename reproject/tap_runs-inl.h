// Taps of neighboring pixels that are neighbors themselves. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_REPROJECT_TAP_RUNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_REPROJECT_TAP_RUNS_INL_H_
#undef EIGENLIGHT_REPROJECT_TAP_RUNS_INL_H_
#else
#define EIGENLIGHT_REPROJECT_TAP_RUNS_INL_H_
#endif

#include "frame/simd-inl.h"
#include "reproject/taps.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

/// Lanes of a vector of pixels whose taps lie side by side: lane i has its upper left tap at
/// (x + i, y). Most vectors are one run, and loads are much faster than gathers.
struct TapRun {
  int x, y;
  MF lanes;
};

/// Splits `lanes` of the vector of pixels that starts at number `at` of a segment into runs, and
/// calls visit(run) for each.
template <class Visit>
HWY_INLINE void ForEachRun(const TapSegment& taps, int at, MF lanes, const Visit& visit) {
  const F d;
  const I di;
  const std::int32_t *x = taps.x + at, *y = taps.y + at;
  const VI start = hn::Sub(Load(di, x), hn::Iota(di, 0));
  while (!AllFalse(d, lanes)) {
    const std::size_t first = hn::FindKnownFirstTrue(d, lanes);
    TapRun run{x[first] - static_cast<int>(first), y[first], {}};
    const auto same = And(Eq(start, Set(di, run.x)), Eq(Load(di, y), Set(di, run.y)));
    run.lanes = And(lanes, RebindMask(d, same));
    lanes = AndNot(run.lanes, lanes);
    visit(run);
  }
}

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
