// What the kernels of the soft a-trous filter share. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_SPATIAL_SOFT_ATROUS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_SPATIAL_SOFT_ATROUS_INL_H_
#undef EIGENLIGHT_SPATIAL_SOFT_ATROUS_INL_H_
#else
#define EIGENLIGHT_SPATIAL_SOFT_ATROUS_INL_H_
#endif

#include "spatial/atrous_taps-inl.h"
#include "spatial/soft_atrous_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

/// Sums of weights below this are 0: their inverses and the squares of these stay finite.
inline constexpr float kLeastSoftSum = 1e-15f;

/// 1 / sum where `mask` holds and the sum is not 0, else 0.
HWY_INLINE VF SoftInverse(VF sum, MF mask) {
  return IfThenElseZero(And(mask, Gt(sum, Set(kLeastSoftSum))), Div(Set(1), sum));
}

/// e(x) of x / 8.
HWY_INLINE VF SoftFalloff(VF eighth) {
  const VF a = Max(Sub(Set(1), eighth), Zero());
  const VF b = Mul(a, a), c = Mul(b, b);
  return Mul(c, c);
}

HWY_INLINE VF SoftLuminance(const VF3& color) {
  const auto term = [&](int c) { return Mul(Set(static_cast<float>(kLuminance[c])), color[c]); };
  return Add(Add(term(0), term(1)), term(2));
}

/// Where pixels show a surface.
HWY_INLINE MF SoftSurface(const SoftGuides& guides, int x, int y) {
  return Lt(Load(guides[kSoftGuides - 1], x, y), Set(kNoSoftSurface));
}

/// Calls visit(x, taps) for the vectors of [x0, x1), taps up to `reach` steps away.
template <class Visit>
HWY_INLINE void ForEachSoftVector(int x0, int x1, int width, int reach, int step,
                                  const Visit& visit) {
  for (int x = x0; x < x1; x += LaneCount()) {
    if (x >= reach * step && x + LaneCount() + reach * step <= width) {
      visit(x, InnerTaps{x, step});
    } else {
      visit(x, EdgeTaps{x, step, width - 1});
    }
  }
}

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
