// The range function of the pyramid filter for vectors of pixels. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_SPATIAL_RIVALS_PYRAMID_ENERGY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_SPATIAL_RIVALS_PYRAMID_ENERGY_INL_H_
#undef EIGENLIGHT_SPATIAL_RIVALS_PYRAMID_ENERGY_INL_H_
#else
#define EIGENLIGHT_SPATIAL_RIVALS_PYRAMID_ENERGY_INL_H_
#endif

#include "frame/simd-inl.h"
#include "spatial/rivals/pyramid_block.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

HWY_INLINE VF16 Set16(float v) { return Set(F16(), v); }

/// 2^x for x in [-126, 0]: Taylor series of 2^f, |f| <= 1/2, to 2.4e-6 of its value.
HWY_INLINE VF16 Exp2(VF16 x) {
  const F16 d;
  const hn::RebindToSigned<F16> di;
  const VF16 whole = hn::Round(x), f = Sub(x, whole);
  VF16 p = MulAdd(f, Set16(0.00133335581f), Set16(0.00961812911f));
  p = MulAdd(p, f, Set16(0.0555041087f));
  p = MulAdd(p, f, Set16(0.240226507f));
  p = MulAdd(p, f, Set16(0.693147181f));
  p = MulAdd(p, f, Set16(1.0f));
  const auto exponent = hn::ShiftLeft<23>(ConvertTo(di, whole));
  return hn::BitCast(d, Add(hn::BitCast(di, p), exponent));
}

/// f^R, or another power of it, from the energy in octaves; 2^-126 from there on.
HWY_INLINE VF16 Range(VF16 octaves) { return Exp2(Max(hn::Neg(octaves), Set16(-126.0f))); }

/// What is compared of a vector of pixels. Normal and depth are 0 where there is no surface.
struct Attributes {
  Vec3<VF16> normal;
  VF16 depth;

  [[nodiscard]] HWY_INLINE MF16 Exists() const { return Gt(depth, Zero(F16())); }
};

/// Energies between a vector of pixels and their samples.
class Energies {
 public:
  Energies(const GlobalIlluminationEdge& edge, const Attributes& own) : own_(own) {
    const float log2e = 1.44269504f;
    normal_scale_ = Set16(edge.normal_power * log2e);
    // Without a surface the normal of 0 keeps all samples away, and nothing divides by 0.
    const VF16 depth = IfThenElse(own.Exists(), own.depth, Set16(1.0f));
    depth_scale_ = Div(Set16(edge.depth_scale * log2e), depth);
  }

  /// In octaves; `alike` is false where it is infinite. -ln(cosine) as the first four terms of its
  /// series in 1 - cosine: f^R is exact to 5e-4 at sigma_N = 8, to 1e-6 at 64.
  HWY_INLINE VF16 Of(const Attributes& sample, MF16& alike) const {
    const VF16 cosine = Dot(own_.normal, sample.normal);
    alike = Gt(cosine, Zero(F16()));
    const VF16 u = Max(Sub(Set16(1.0f), cosine), Zero(F16()));
    VF16 bend = MulAdd(u, Set16(0.25f), Set16(1.0f / 3.0f));
    bend = MulAdd(bend, u, Set16(0.5f));
    bend = MulAdd(bend, u, Set16(1.0f));
    bend = Mul(Mul(bend, u), normal_scale_);
    return MulAdd(Abs(Sub(own_.depth, sample.depth)), depth_scale_, bend);
  }

 private:
  Attributes own_;
  VF16 normal_scale_, depth_scale_;  // sigma_N log2(e), sigma_z log2(e) / z_p
};

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
