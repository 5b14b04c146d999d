#include "temporal/bases/predict.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/predict_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
// Of the largest usable light; a gain may ask for more than float can hold.
constexpr float kLargestVariance = kLargestLight * kLargestLight;

// The variance of one frame, where the light is `gain` times what it was.
VF FollowGain(VF variance, VF gain) {
  const VF half = Set(0.5f), one = Set(1), two = Set(2);
  const VF small = IfThenElse(Lt(gain, half), Mul(two, gain), one);
  const VF beyond = IfThenElse(Gt(gain, two), Mul(half, gain), small);
  const VF scaled = Mul(Mul(beyond, variance), beyond);
  const VF largest = Set(kLargestVariance);
  return IfThenElse(Lt(scaled, largest), scaled, largest);
}

// The vector of pixels from column x of row y on, the i-th of its tile.
void PredictVector(const BasisField& bases, const CoefficientRows& coefficient, int rank, int x,
                   int y, int i, const PredictOutputs& out) {
  const F d;
  const float* block = bases.at(x, y);
  prefetch_below(bases, x, y);
  VF innovation = Zero(), expected = Zero();
  for (int c = 0; c < 3; ++c) {
    VF sum = Zero();
    for (int k = 0; k < rank; ++k) {
      const float* basis = block + kBlock * bases.line_of(c, k);
      sum = MulAdd(Load(d, coefficient[k] + i), Load(d, basis), sum);
    }
    const VF residual = Sub(Load(out.residual[c], x, y), sum);
    Store(residual, out.residual[c], x, y);
    const VF weight = Set(static_cast<float>(kLuminance[c]));
    innovation = MulAdd(weight, residual, innovation);
    expected = MulAdd(weight, sum, expected);
  }
  const MF known = Gt(Load(d, bases.ages(x, y)), Zero());
  const MF confirmed = And(known, Le(Abs(innovation), Set(kLargest)));  // false for NaN
  StoreAndPrefetch(IfThenElse(confirmed, innovation, NaN()), out.innovation, x, y);
  StoreAndPrefetch(expected, out.expected, x, y);
  const VF variance = LoadAndPrefetch(out.variance, x, y);
  Store(FollowGain(variance, Load(d, coefficient[0] + i)), out.variance, x, y);
}

void PredictTile(const BasisField& bases, const CoefficientField& coefficients, const Rect& tile,
                 const PredictOutputs& out) {
  const int lanes = LaneCount(), rank = coefficients.used();
  CoefficientRows coefficient;
  for (int y = tile.y0; y < tile.y1; ++y) {
    coefficients.rows({tile.x0, y, tile.x1, y + 1}, rank, coefficient);
    for (int i = 0; i < tile.x1 - tile.x0; i += lanes) {
      PredictVector(bases, coefficient, rank, tile.x0 + i, y, i, out);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(PredictTile);

void predict_tile(const BasisField& bases, const CoefficientField& coefficients, const Rect& tile,
                  const PredictOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kCoefficientTile);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(PredictTile)(bases, coefficients, tile, out);
}

}  // namespace eigenlight
#endif
