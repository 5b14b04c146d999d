// What filters that weigh many taps by exponentials share. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_SPATIAL_RIVALS_TAP_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_SPATIAL_RIVALS_TAP_PLANES_INL_H_
#undef EIGENLIGHT_SPATIAL_RIVALS_TAP_PLANES_INL_H_
#else
#define EIGENLIGHT_SPATIAL_RIVALS_TAP_PLANES_INL_H_
#endif

#include "frame/math-inl.h"
#include "spatial/rivals/tap_planes.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

/// One row of three planes of TapPlanes, from column 0 on.
struct TapRows {
  const float* at[3];

  TapRows(const TapPlanes& planes, const Planes<3>& of, int y)
      : at{planes.row(of[0], y), planes.row(of[1], y), planes.row(of[2], y)} {}

  [[nodiscard]] HWY_INLINE Vec3<VF16> Load(int x) const {
    const F16 d;
    return {{LoadU(d, at[0] + x), LoadU(d, at[1] + x), LoadU(d, at[2] + x)}};
  }
};

HWY_INLINE VF16 SquaredDistance(const Vec3<VF16>& a, const Vec3<VF16>& b) {
  const Vec3<VF16> off{{Sub(a[0], b[0]), Sub(a[1], b[1]), Sub(a[2], b[2])}};
  return Dot(off, off);
}

/// Weighted sums over the taps of a vector of pixels.
struct TapSums {
  Vec3<VF16> color;
  VF16 weight;

  HWY_INLINE TapSums() : weight(Zero(F16())) {
    for (int c = 0; c < 3; ++c) color[c] = weight;
  }

  HWY_INLINE void Add(VF16 w, const Vec3<VF16>& value) {
    for (int c = 0; c < 3; ++c) color[c] = MulAdd(w, value[c], color[c]);
    weight = hn::Add(weight, w);
  }

  /// Pixels that show a surface and have a tap of any weight.
  [[nodiscard]] MF16 HasMean(const TapPlanes& planes, int x, int y) const {
    const F16 d;
    const VF16 surface = LoadU(d, planes.row(planes.surface, y) + x);
    return And(Gt(surface, Zero(d)), Gt(weight, Zero(d)));
  }
  [[nodiscard]] VF16 Mean(int c) const { return Div(color[c], weight); }
};

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
