#include <limits>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/bases/predict.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/predict_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

constexpr float kLargest = std::numeric_limits<float>::max();
// Of the largest usable light; a gain may ask for more than float can hold.
constexpr float kLargestVariance = kLargestLight * kLargestLight;

// The variance of one frame, where the light is `gain` times what it was.
VF FollowGain(VF variance, VF gain) {
  const F d;
  const VF half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const VF small = hn::IfThenElse(hn::Lt(gain, half), hn::Mul(two, gain), one);
  const VF beyond = hn::IfThenElse(hn::Gt(gain, two), hn::Mul(half, gain), small);
  const VF scaled = hn::Mul(hn::Mul(beyond, variance), beyond);
  const VF largest = hn::Set(d, kLargestVariance);
  return hn::IfThenElse(hn::Lt(scaled, largest), scaled, largest);
}

// The vector of pixels from column x of row y on, the i-th of its tile.
void PredictVector(const BasisField& bases, const CoefficientRows& coefficient, int rank, int x,
                   int y, int i, const PredictOutputs& out) {
  const F d;
  const float weights[3] = {0.2126f, 0.7152f, 0.0722f};  // luminance, Rec. 709
  const float* block = bases.at(x, y);
  prefetch_below(bases, x, y);
  VF innovation = hn::Zero(d), expected = hn::Zero(d);
  for (std::size_t c = 0; c < 3; ++c) {
    VF sum = hn::Zero(d);
    for (int k = 0; k < rank; ++k) {
      const float* basis = block + kBlock * bases.line_of(static_cast<int>(c), k);
      sum = hn::MulAdd(hn::Load(d, coefficient[k] + i), hn::Load(d, basis), sum);
    }
    float* light = out.residual[c].row(y) + x;
    const VF residual = hn::Sub(hn::LoadU(d, light), sum);
    hn::StoreU(residual, d, light);
    innovation = hn::MulAdd(hn::Set(d, weights[c]), residual, innovation);
    expected = hn::MulAdd(hn::Set(d, weights[c]), sum, expected);
  }
  for (const Plane<float>* plane : {&out.innovation, &out.expected, &out.variance}) {
    prefetch_below(*plane, x, y);
  }
  const auto known = hn::Gt(hn::Load(d, bases.ages(x, y)), hn::Zero(d));
  // False of NaN.
  const auto confirmed = hn::And(known, hn::Le(hn::Abs(innovation), hn::Set(d, kLargest)));
  const VF nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
  hn::StoreU(hn::IfThenElse(confirmed, innovation, nan), d, out.innovation.row(y) + x);
  hn::StoreU(expected, d, out.expected.row(y) + x);
  float* variance = out.variance.row(y) + x;
  hn::StoreU(FollowGain(hn::LoadU(d, variance), hn::Load(d, coefficient[0] + i)), d, variance);
}

void PredictTile(const BasisField& bases, const CoefficientField& coefficients, const Rect& tile,
                 const PredictOutputs& out) {
  const int lanes = static_cast<int>(hn::Lanes(F())), rank = coefficients.used();
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
