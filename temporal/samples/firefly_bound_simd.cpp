#include "temporal/samples/firefly_bound.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/firefly_bound_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Squared innovation that a confirmed pixel is expected to have.
VF8 Expected(MF8 confirmed, VF8 variance, VF8 samples, VF8 age, VF8 expected) {
  const F8 d;
  const VF8 one = Set(d, 1.0f);
  const VF8 s = IfThenElse(confirmed, samples, one), n = IfThenElse(confirmed, age, one);
  const VF8 light = Mul(Set(d, 0.1f), expected);
  return MulAdd(light, light, Mul(variance, Add(Div(one, s), Div(one, n))));
}

FireflyBlock CountFireflies(const FireflyInputs& in, float deviations, const FireflyOutputs& out,
                            const Rect& block) {
  const F8 d;  // a vector is a row of a block
  const VF8 zero = Zero(d), square = Set(d, deviations * deviations);
  FireflyBlock counts;
  const auto count = [&](int x, int y) {
    const auto load = [&](const Plane<float>& plane) { return Load(plane, x, y, d); };
    const MF8 inside = FirstLanes(block.x1 - x, d);
    const VF8 r = load(out.innovation), prediction = load(in.expected);
    const VF8 samples = IfThenElseZero(inside, load(in.samples));
    const MF8 confirmed = AndNot(IsNaN(r), inside), usable = Gt(samples, zero);
    const VF8 expected = Expected(confirmed, load(in.variance), samples, load(in.age), prediction);
    const MF8 outlier = And(confirmed, Gt(Mul(r, r), Mul(square, expected)));
    const VF8 off = Luminance(Load(out.residual, x, y, d));
    const VF8 root = Sqrt(IfThenElseZero(usable, Abs(Add(prediction, off))));
    counts.confirmed += CountLanes(confirmed, d);
    counts.outliers += CountLanes(outlier, d);
    counts.usable += CountLanes(usable, d);
    counts.fresh += CountLanes(AndNot(confirmed, usable), d);
    counts.root += SumLanes(root, d);
  };
  ForEachVector(block, count, d);
  return counts;
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(CountFireflies);

FireflyBlock count_fireflies(const FireflyInputs& in, float deviations, const FireflyOutputs& out,
                             const Rect& block) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  return HWY_DYNAMIC_DISPATCH(CountFireflies)(in, deviations, out, block);
}

}  // namespace eigenlight
#endif
