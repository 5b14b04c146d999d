#include <algorithm>

#include "spatial/soft_atrous_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/soft_means_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/soft_atrous-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

void StartRow(const SoftGuides& guides, const SoftWork& work, int y) {
  for (int x = 0; x < guides[0].width(); x += LaneCount()) {
    VF3 light = Load(*work.light, x, y);
    const VF variance = Load(*work.variance, x, y);
    const MF good = And(And(IsFinite(Add(Add(light[0], light[1]), light[2])), IsFinite(variance)),
                        SoftSurface(guides, x, y));
    for (int c = 0; c < 3; ++c) light[c] = IfThenElseZero(good, light[c]);
    Store(light, *work.light, x, y);
    Store(IfThenElseZero(good, variance), *work.variance, x, y);
    Store(IfThenElseZero(good, Set(1)), *work.usable, x, y);
    Store(SoftLuminance(light), *work.luminance, x, y);
  }
}

struct MeanSums {
  VF sum, squares, mean, spread;
};

// The pixel j columns and dy rows away; `geometry` 1 or as found.
template <bool kFirst, class Taps>
HWY_INLINE void AddNear(const SoftWork& work, const Taps& taps, int j, int line, VF geometry,
                        float kernel, MeanSums& sums) {
  VF weight = Mul(Set(kernel), geometry);
  if constexpr (kFirst) weight = Mul(weight, taps.Load(work.usable->row(line), j));
  sums.sum = Add(sums.sum, weight);
  sums.squares = Add(sums.squares, Mul(weight, weight));
  sums.mean = Add(sums.mean, Mul(weight, taps.Load(work.luminance->row(line), j)));
  sums.spread = Add(sums.spread, Mul(weight, taps.Load(work.variance->row(line), j)));
}

template <bool kFirst, class Taps>
HWY_INLINE void MeansVector(const SoftPass& pass, const SoftWork& work, const Taps& taps, int x,
                            int y) {
  constexpr float kSide = 0.125f, kCorner = 0.0625f;
  MeanSums sums{Zero(), Zero(), Zero(), Zero()};
  // A weight is kept at the upper pixel, or at the left one.
  const auto here = [&](int j, int dy, std::size_t plane, float kernel) {
    AddNear<kFirst>(work, taps, j, y + dy, Load(pass.near[plane], x, y), kernel, sums);
  };
  const auto there = [&](int j, int dy, std::size_t plane, float kernel) {
    const VF geometry = taps.Load(pass.near[plane].row(y + dy), j);
    AddNear<kFirst>(work, taps, j, y + dy, geometry, kernel, sums);
  };
  AddNear<kFirst>(work, taps, 0, y, Set(1), 0.25f, sums);
  here(1, 0, 0, kSide);
  there(-1, 0, 0, kSide);
  if (y + 1 < work.mean->height()) {
    here(-1, 1, 1, kCorner);
    here(0, 1, 2, kSide);
    here(1, 1, 3, kCorner);
  }
  if (y > 0) {
    there(1, -1, 1, kCorner);
    there(0, -1, 2, kSide);
    there(-1, -1, 3, kCorner);
  }
  const VF over = SoftInverse(sums.sum, Eq(Zero(), Zero()));
  const VF mean = Mul(sums.mean, over);
  const VF spread = Mul(Mul(Mul(sums.spread, over), Mul(sums.squares, over)), over);
  const VF deviations = Mul(Set(4.0f * work.sigmas), Sqrt(Max(spread, Zero())));
  const VF rounding = Add(Mul(Set(4e-4f), Abs(mean)), Set(4e-6f));
  Store(mean, *work.mean, x, y);
  Store(Add(deviations, rounding), *work.tolerance, x, y);
}

void MeansRow(const SoftPass& pass, int y) {
  const int width = pass.guides[0].width();
  for (const SoftWork& work : pass.work) {
    ForEachSoftVector(0, width, width, 1, 1, [&](int x, const auto& taps) {
      if (pass.is_first) {
        MeansVector<true>(pass, work, taps, x, y);
      } else {
        MeansVector<false>(pass, work, taps, x, y);
      }
    });
  }
}

// Luminance of five rows, NaN where pixels do not count.
struct Around {
  static constexpr int kPixels = 64, kMargin = 64;
  alignas(64) float line[5][kPixels + 2 * kMargin];

  // Of the pixels [x0, x0 + kPixels), from kMargin on, and of two or more on either side.
  void fill(const FrameInput& frame, const Planes<3>& light, int x0, int y) {
    const Extent extent = frame.extent();
    const int beside = std::max(LaneCount(), 2);
    for (int dy = -2; dy <= 2; ++dy) {
      for (int i = -beside; i < kPixels + beside; i += LaneCount()) {
        const int x = x0 + i, row = y + dy;
        VF value = NaN();
        if (x >= 0 && x < extent.width && row >= 0 && row < extent.height) {
          const VF found = SoftLuminance(Load(light, x, row));
          const MF counts = And(And(HasSurface(frame.surface.id, x, row), IsFinite(found)),
                                Lt(Iota(x), Set(extent.width)));
          value = IfThenElse(counts, found, NaN());
        }
        StoreU(value, F(), line[dy + 2] + kMargin + i);
      }
    }
  }

  // Sums of differences from the pixel itself: their squares lose no digits.
  [[nodiscard]] VF Variance(int column) const {
    const VF own = Load(F(), line[2] + column), center = IfThenZeroElse(IsNaN(own), own);
    VF count = Zero(), sum = Zero(), squares = Zero();
    for (const auto& row : line) {
      for (int dx = -2; dx <= 2; ++dx) {
        const VF value = LoadU(F(), row + column + dx);
        const MF counts = Not(IsNaN(value));
        const VF apart = IfThenElseZero(counts, Sub(value, center));
        count = Add(count, IfThenElseZero(counts, Set(1)));
        sum = Add(sum, apart);
        squares = Add(squares, Mul(apart, apart));
      }
    }
    const VF mean = Div(sum, count), variance = Sub(Div(squares, count), Mul(mean, mean));
    // What overflows stays NaN.
    return IfThenElseZero(Gt(count, Set(1)), IfThenZeroElse(Lt(variance, Zero()), variance));
  }
};

void VarianceRow(const FrameInput& frame, const Planes<3>& light, int y, Plane<float>& variance) {
  Around around;
  for (int x0 = 0; x0 < variance.width(); x0 += Around::kPixels) {
    around.fill(frame, light, x0, y);
    const int x1 = std::min(x0 + Around::kPixels, variance.width());
    for (int x = x0; x < x1; x += LaneCount()) {
      Store(around.Variance(Around::kMargin + x - x0), variance, x, y);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(StartRow);
HWY_EXPORT(MeansRow);
HWY_EXPORT(VarianceRow);

void soft_start_row(const SoftGuides& guides, const SoftWork& work, int y) {
  const FloatTrapsOff files_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(StartRow)(guides, work, y);
}

void soft_means_row(const SoftPass& pass, int y) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(MeansRow)(pass, y);
}

void soft_variance_row(const FrameInput& frame, const Planes<3>& light, int y,
                       Plane<float>& variance) {
  const FloatTrapsOff files_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(VarianceRow)(frame, light, y, variance);
}

}  // namespace eigenlight
#endif
