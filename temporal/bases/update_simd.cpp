#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/bases/update.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/update_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;

struct Row {
  CoefficientRows coefficient;     // c; c_0 is the gain
  CoefficientRows learning_rates;  // q
};

// A vector of pixels from column x on of row y, the i-th of its tile. Lanes behind the last pixel
// count as without samples and history, so that their bases and age stay 0.
struct Place {
  int x, y, i;
  MF lanes;
};

VF Load(const Plane<float>& plane, const Place& at) {
  prefetch_below(plane, at.x, at.y);
  return hn::Load(F(), plane.row(at.y) + at.x);
}

void Store(VF v, const Place& at, Plane<float>& plane) {
  prefetch_below(plane, at.x, at.y);
  hn::Store(v, F(), plane.row(at.y) + at.x);
}

// What a vector of pixels does with all of its channels.
struct Step {
  VF leverage;  // 1 / h
  VF weight;    // s / (n + h s)
  VF age;
  MF usable, known;
};

Step FindStep(const UpdateInputs& in, const Place& at, const Row& row) {
  const F d;
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  VF h = hn::Load(d, row.learning_rates[0] + at.i);
  for (int k = 1; k < in.active; ++k) {
    h = hn::MulAdd(hn::Load(d, row.coefficient[k] + at.i),
                   hn::Load(d, row.learning_rates[k] + at.i), h);
  }
  // M is positive definite, so h >= 1 / M_00 = 1 at tile centers; interpolation may fall short.
  h = hn::IfThenElse(hn::Gt(h, one), h, one);
  const VF samples = Load(in.samples, at), age = Load(in.new_age, at);
  Step step;
  step.usable = hn::And(at.lanes, hn::Gt(samples, zero));
  step.known = hn::And(at.lanes, hn::Gt(Load(in.old_age, at), zero));
  const VF history =
      hn::IfThenElseZero(hn::And(step.known, hn::Gt(age, samples)), hn::Sub(age, samples));
  const VF total = hn::IfThenElse(step.usable, hn::MulAdd(h, samples, history), one);
  step.leverage = hn::Div(one, h);
  step.weight = hn::IfThenElseZero(step.usable, hn::Div(samples, total));
  step.age = hn::IfThenElseZero(hn::Or(step.usable, step.known), age);
  return step;
}

// Channel c of a vector of pixels. Returns the estimate.
VF UpdateBases(const UpdateInputs& in, const Step& step, VF residual, VF correction, int c,
               const Place& at, const Row& row, BasisField& bases) {
  const F d;
  float* block = bases.at(at.x, at.y);
  const auto line = [&](int k) { return block + kBlock * bases.line_of(c, k); };
  VF move = hn::IfThenElseZero(step.usable, hn::Mul(step.weight, residual));
  if (in.newborn == 0) move = hn::MulAdd(correction, step.leverage, move);
  const auto learning_rates = [&](int k) { return hn::Load(d, row.learning_rates[k] + at.i); };
  const auto coefficient = [&](int k) { return hn::Load(d, row.coefficient[k] + at.i); };
  const auto old = [&](int k) { return hn::IfThenElseZero(step.known, hn::Load(d, line(k))); };
  VF estimate = hn::MulAdd(learning_rates(0), move, hn::Mul(coefficient(0), old(0)));
  hn::Store(estimate, d, line(0));
  for (int k = 1; k < in.active; ++k) {
    const VF value = hn::MulAdd(learning_rates(k), move, old(k));
    hn::Store(value, d, line(k));
    estimate = hn::MulAdd(coefficient(k), value, estimate);
  }
  for (int k = in.active; k < bases.bases(); ++k) hn::Store(hn::Zero(d), d, line(k));
  if (in.newborn == 0) return estimate;
  hn::Store(correction, d, line(in.newborn));
  return hn::Add(estimate, correction);
}

void UpdateVector(const UpdateInputs& in, const Place& at, const Row& row,
                  const UpdateOutputs& out) {
  const Step step = FindStep(in, at, row);
  prefetch_below(out.bases, at.x, at.y);
  for (std::size_t c = 0; c < 3; ++c) {
    const VF correction = in.correction == nullptr
                              ? hn::Zero(F())
                              : hn::IfThenElseZero(step.known, Load((*in.correction)[c], at));
    const VF residual = hn::Sub(Load(in.residual[c], at), correction);
    Store(UpdateBases(in, step, residual, correction, static_cast<int>(c), at, row, out.bases), at,
          out.estimate[c]);
  }
  hn::Store(step.age, F(), out.bases.ages(at.x, at.y));
}

void UpdateTile(const UpdateInputs& in, const Rect& tile, const UpdateOutputs& out) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Rect segment{tile.x0, y, tile.x1, y + 1};
    in.coefficients.rows(segment, in.active, row.coefficient);
    in.learning_rates.rows(segment, in.active, row.learning_rates);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      UpdateVector(in, {x, y, x - tile.x0, hn::FirstN(d, static_cast<std::size_t>(tile.x1 - x))},
                   row, out);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(UpdateTile);

void update_tile(const UpdateInputs& in, const Rect& tile, const UpdateOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kCoefficientTile);
  EL_DCHECK(in.active <= out.bases.bases() && in.newborn < out.bases.bases());
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(UpdateTile)(in, tile, out);
}

}  // namespace eigenlight
#endif
