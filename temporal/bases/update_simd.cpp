#include "temporal/bases/update.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/update_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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

VF LoadAt(const Plane<float>& plane, const Place& at) { return LoadAndPrefetch(plane, at.x, at.y); }

// What a vector of pixels does with all of its channels.
struct Step {
  VF leverage;  // 1 / h
  VF weight;    // s / (n + h s)
  VF age;
  MF usable, known;
};

Step FindStep(const UpdateInputs& in, const Place& at, const Row& row) {
  const F d;
  const VF zero = Zero(), one = Set(1.0f);
  VF h = Load(d, row.learning_rates[0] + at.i);
  for (int k = 1; k < in.active; ++k) {
    h = MulAdd(Load(d, row.coefficient[k] + at.i), Load(d, row.learning_rates[k] + at.i), h);
  }
  // M is positive definite, so h >= 1 / M_00 = 1 at tile centers; interpolation may fall short.
  h = IfThenElse(Gt(h, one), h, one);
  const VF samples = LoadAt(in.samples, at), age = LoadAt(in.new_age, at);
  Step step;
  step.usable = And(at.lanes, Gt(samples, zero));
  step.known = And(at.lanes, Gt(LoadAt(in.old_age, at), zero));
  const VF history = IfThenElseZero(And(step.known, Gt(age, samples)), Sub(age, samples));
  const VF total = IfThenElse(step.usable, MulAdd(h, samples, history), one);
  step.leverage = Div(one, h);
  step.weight = IfThenElseZero(step.usable, Div(samples, total));
  step.age = IfThenElseZero(Or(step.usable, step.known), age);
  return step;
}

// Channel c of a vector of pixels. Returns the estimate.
VF UpdateBases(const UpdateInputs& in, const Step& step, VF residual, VF correction, int c,
               const Place& at, const Row& row, BasisField& bases) {
  const F d;
  float* block = bases.at(at.x, at.y);
  const auto line = [&](int k) { return block + kBlock * bases.line_of(c, k); };
  VF move = IfThenElseZero(step.usable, Mul(step.weight, residual));
  if (in.newborn == 0) move = MulAdd(correction, step.leverage, move);
  const auto learning_rates = [&](int k) { return Load(d, row.learning_rates[k] + at.i); };
  const auto coefficient = [&](int k) { return Load(d, row.coefficient[k] + at.i); };
  const auto old = [&](int k) { return IfThenElseZero(step.known, Load(d, line(k))); };
  VF estimate = MulAdd(learning_rates(0), move, Mul(coefficient(0), old(0)));
  Store(estimate, d, line(0));
  for (int k = 1; k < in.active; ++k) {
    const VF value = MulAdd(learning_rates(k), move, old(k));
    Store(value, d, line(k));
    estimate = MulAdd(coefficient(k), value, estimate);
  }
  for (int k = in.active; k < bases.bases(); ++k) Store(Zero(), d, line(k));
  if (in.newborn == 0) return estimate;
  Store(correction, d, line(in.newborn));
  return Add(estimate, correction);
}

void UpdateVector(const UpdateInputs& in, const Place& at, const Row& row,
                  const UpdateOutputs& out) {
  const Step step = FindStep(in, at, row);
  prefetch_below(out.bases, at.x, at.y);
  for (int c = 0; c < 3; ++c) {
    const VF correction = in.correction == nullptr
                              ? Zero()
                              : IfThenElseZero(step.known, LoadAt((*in.correction)[c], at));
    const VF residual = Sub(LoadAt(in.residual[c], at), correction);
    const VF estimate = UpdateBases(in, step, residual, correction, c, at, row, out.bases);
    StoreAndPrefetch(estimate, out.estimate[c], at.x, at.y);
  }
  Store(step.age, F(), out.bases.ages(at.x, at.y));
}

void UpdateTile(const UpdateInputs& in, const Rect& tile, const UpdateOutputs& out) {
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Rect segment{tile.x0, y, tile.x1, y + 1};
    in.coefficients.rows(segment, in.active, row.coefficient);
    in.learning_rates.rows(segment, in.active, row.learning_rates);
    for (int x = tile.x0; x < tile.x1; x += LaneCount()) {
      UpdateVector(in, {x, y, x - tile.x0, FirstLanes(tile.x1 - x)}, row, out);
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
