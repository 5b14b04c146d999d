// Sums over eight neighboring windows of the guided filter. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_SPATIAL_GUIDED_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_SPATIAL_GUIDED_SUMS_INL_H_
#undef EIGENLIGHT_SPATIAL_GUIDED_SUMS_INL_H_
#else
#define EIGENLIGHT_SPATIAL_GUIDED_SUMS_INL_H_
#endif

#include <hwy/cache_control.h>

#include "frame/simd-inl.h"
#include "spatial/guided_filter_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

/// Writes lane i of the eight vectors to the eight floats at to + i * stride, for all lanes.
HWY_INLINE void StoreTransposed(const VF8 (&v)[kGuidedBlock], std::size_t stride,
                                float* HWY_RESTRICT to) {
#if HWY_TARGET == HWY_SCALAR
  for (int i = 0; i < kGuidedBlock; ++i) to[i] = v[i].raw;
  static_cast<void>(stride);
#else
  const F8 d;
  const hn::Repartition<std::uint64_t, F8> pairs;
  // Of each 128 bits: column[half][i] is lane i of the vectors 4 half to 4 half + 3.
  VF8 column[2][4];
  for (int half = 0; half < 2; ++half) {
    const VF8* rows = v + 4 * half;
    const auto low0 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[0], rows[1]));
    const auto low1 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[2], rows[3]));
    const auto high0 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[0], rows[1]));
    const auto high1 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[2], rows[3]));
    column[half][0] = hn::BitCast(d, hn::InterleaveLower(pairs, low0, low1));
    column[half][1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low0, low1));
    column[half][2] = hn::BitCast(d, hn::InterleaveLower(pairs, high0, high1));
    column[half][3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high0, high1));
  }
  for (std::size_t i = 0; i < 4; ++i) {
    if (LaneCount(d) == 4) {
      Store(column[0][i], d, to + i * stride);
      Store(column[1][i], d, to + i * stride + 4);
    } else {
      Store(hn::ConcatLowerLower(d, column[1][i], column[0][i]), d, to + i * stride);
      Store(hn::ConcatUpperUpper(d, column[1][i], column[0][i]), d, to + (i + 4) * stride);
    }
  }
#endif
}

/// SumWindows() of windows that have no row in common.
template <typename AddRow>
HWY_INLINE VF8 SumShortWindows(const GuidedWindow& w, const AddRow& add, VF8 (&sum)[kGuidedBlock]) {
  VF8 after = Zero(F8());
  for (int g = 0; g < kGuidedBlock; ++g) {
    after = add(after, w.at[w.span + g]);
    sum[g] = Zero(F8());
    for (int i = g; i <= g + w.span; ++i) sum[g] = add(sum[g], w.at[i]);
  }
  return after;
}

/// Sets `sum` to the sums of eight windows, and returns that of the eight newest rows. add(sum, at)
/// adds a row to a sum, whole(at) is a sum of eight rows. Nothing is subtracted: a sum holds no
/// trace of rows outside its window.
template <typename AddRow, typename WholeSum>
HWY_INLINE VF8 SumWindows(const GuidedWindow& w, const AddRow& add, const WholeSum& whole,
                          VF8 (&sum)[kGuidedBlock]) {
  if (w.span < kGuidedBlock) return SumShortWindows(w, add, sum);
  VF8 before = Zero(F8()), after = before;
  for (int i = 0; i < w.sum_count; ++i) before = Add(before, whole(w.sums[i]));
  for (int i = 0; i < w.rest_count; ++i) before = add(before, w.rest[i]);
  for (int g = kGuidedBlock - 1; g >= 0; --g) {
    sum[g] = before = add(before, w.at[g]);
  }
  for (int g = 0; g < kGuidedBlock; ++g) {
    after = add(after, w.at[w.span + g]);
    sum[g] = Add(sum[g], after);
  }
  return after;
}

/// Floats of a row and of a sum.
struct GuidedLengths {
  int row, sum;
};

/// Prefetches the rows and sums that SumWindows() will read: those of wide windows do not fit the
/// second-level cache.
inline void PrefetchWindows(const GuidedWindow& w, const float* rows, const float* sums,
                            const GuidedLengths& lengths) {
  constexpr int kLine = 16;
  for (int g = 0; g < kGuidedBlock; ++g) {
    for (int x = 0; x < lengths.row; x += kLine) hwy::Prefetch(rows + w.at[g] + x);
  }
  for (int i = 0; i < w.sum_count; ++i) {
    for (int x = 0; x < lengths.sum; x += kLine) hwy::Prefetch(sums + w.sums[i] + x);
  }
}

/// Calls visit(sum, add) for each sum that the fit of kN guides needs of a block of columns, in the
/// order of guided_sums(). add(v, row) adds to v what one row gives to the sum.
template <int kN, typename Visit>
void ForEachSum(const float* values, const Visit& visit) {
  const F8 d;
  const auto at = [=](int value, std::size_t row) {
    return Load(d, values + row + kGuidedBlock * value);
  };
  int next = 0;
  const auto plain = [&](int a) {
    visit(next++, [=](VF8 sum, std::size_t row) { return Add(sum, at(a, row)); });
  };
  plain(0);
  for (int i = 1; i <= kN; ++i) {
    visit(next++, [=](VF8 sum, std::size_t row) { return MulAdd(at(0, row), at(i, row), sum); });
  }
  for (int c = 1 + kN; c < 4 + kN; ++c) plain(c);
  for (int j = 1; j <= kN; ++j) {
    for (int i = 1; i <= j; ++i) {
      visit(next++, [=](VF8 sum, std::size_t row) {
        return MulAdd(Mul(at(0, row), at(i, row)), at(j, row), sum);
      });
    }
  }
  for (int i = 1; i <= kN; ++i) {
    for (int c = 1 + kN; c < 4 + kN; ++c) {
      visit(next++, [=](VF8 sum, std::size_t row) { return MulAdd(at(c, row), at(i, row), sum); });
    }
  }
}

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
