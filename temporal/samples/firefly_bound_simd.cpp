#include "frame/float_traps.h"
#include "temporal/samples/firefly_bound.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/firefly_bound_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
// Up to eight lanes: a row of a block.
using D = hn::CappedTag<float, 8>;
using V = hn::Vec<D>;

V Luminance(V r, V g, V b) {
  const D d;
  return hn::MulAdd(hn::Set(d, 0.2126f), r,
                    hn::MulAdd(hn::Set(d, 0.7152f), g, hn::Mul(hn::Set(d, 0.0722f), b)));
}

// Squared innovation that a confirmed pixel is expected to have.
V Expected(hn::Mask<D> confirmed, V variance, V samples, V age, V expected) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const V s = hn::IfThenElse(confirmed, samples, one), n = hn::IfThenElse(confirmed, age, one);
  const V light = hn::Mul(hn::Set(d, 0.1f), expected);
  return hn::MulAdd(light, light, hn::Mul(variance, hn::Add(hn::Div(one, s), hn::Div(one, n))));
}

FireflyBlock CountFireflies(const FireflyInputs& in, float deviations, const FireflyOutputs& out,
                            const Rect& block) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V zero = hn::Zero(d), square = hn::Set(d, deviations * deviations);
  FireflyBlock counts;
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; x += lanes) {
      const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
      const auto inside = hn::FirstN(d, static_cast<std::size_t>(block.x1 - x));
      const V r = load(out.innovation), prediction = load(in.expected);
      const V samples = hn::IfThenElseZero(inside, load(in.samples));
      const auto confirmed = hn::AndNot(hn::IsNaN(r), inside), usable = hn::Gt(samples, zero);
      const V expected = Expected(confirmed, load(in.variance), samples, load(in.age), prediction);
      const auto outlier = hn::And(confirmed, hn::Gt(hn::Mul(r, r), hn::Mul(square, expected)));
      const V off = Luminance(load(out.residual[0]), load(out.residual[1]), load(out.residual[2]));
      const V root = hn::Sqrt(hn::IfThenElseZero(usable, hn::Abs(hn::Add(prediction, off))));
      counts.confirmed += static_cast<int>(hn::CountTrue(d, confirmed));
      counts.outliers += static_cast<int>(hn::CountTrue(d, outlier));
      counts.usable += static_cast<int>(hn::CountTrue(d, usable));
      counts.fresh += static_cast<int>(hn::CountTrue(d, hn::AndNot(confirmed, usable)));
      counts.root += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, root)));
    }
  }
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
