#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "reproject/basis_rows.h"
#include "temporal/update.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/update_simd.cpp"
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
  BasisRows from, to;
  CoefficientRows coefficient;  // c; c_0 is the gain
  CoefficientRows learning;     // q
};

// What a vector of pixels does with all of its channels.
struct Step {
  VF leverage;  // 1 / h
  VF weight;    // s / (n + h s)
  MF usable, known;
};

// Leaves the age in row.to.
Step FindStep(const UpdateInputs& in, const Tile& segment, int i, Row& row) {
  const F d;
  const auto load = [&](const Plane<float>& plane) {
    prefetch_below(plane, segment.x0 + i, segment.y0);
    return hn::LoadU(d, plane.row(segment.y0) + segment.x0 + i);
  };
  const VF zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  VF h = hn::Load(d, row.learning[0] + i);
  for (int k = 1; k < in.active; ++k) {
    h = hn::MulAdd(hn::Load(d, row.coefficient[k] + i), hn::Load(d, row.learning[k] + i), h);
  }
  // M is positive definite, so h >= 1 / M_00 = 1 at tile centers; interpolation may fall short.
  h = hn::IfThenElse(hn::Gt(h, one), h, one);
  const VF samples = load(in.samples), age = load(in.new_age);
  Step step;
  step.usable = hn::Gt(samples, zero);
  step.known = hn::Gt(load(in.old_age), zero);
  const VF history =
      hn::IfThenElseZero(hn::And(step.known, hn::Gt(age, samples)), hn::Sub(age, samples));
  const VF total = hn::IfThenElse(step.usable, hn::MulAdd(h, samples, history), one);
  step.leverage = hn::Div(one, h);
  step.weight = hn::IfThenElseZero(step.usable, hn::Div(samples, total));
  hn::Store(hn::IfThenElseZero(hn::Or(step.usable, step.known), age), d, row.to.age + i);
  return step;
}

// One channel of a vector of pixels. Returns the estimate.
VF UpdateBases(const UpdateInputs& in, const Step& step, VF residual, VF correction, int channel,
               int i, const BasisField& from_field, const BasisField& to_field, Row& row) {
  const F d;
  const float(*from)[kSegment] = row.from.values + channel * from_field.bases();
  float(*to)[kSegment] = row.to.values + channel * to_field.bases();
  VF move = hn::IfThenElseZero(step.usable, hn::Mul(step.weight, residual));
  if (in.newborn == 0) move = hn::MulAdd(correction, step.leverage, move);
  const auto old = [&](int k) { return hn::IfThenElseZero(step.known, hn::Load(d, from[k] + i)); };
  const auto q = [&](int k) { return hn::Load(d, row.learning[k] + i); };
  const auto c = [&](int k) { return hn::Load(d, row.coefficient[k] + i); };
  VF estimate = hn::MulAdd(q(0), move, hn::Mul(c(0), old(0)));
  hn::Store(estimate, d, to[0] + i);
  for (int k = 1; k < in.active; ++k) {
    const VF value = hn::MulAdd(q(k), move, old(k));
    hn::Store(value, d, to[k] + i);
    estimate = hn::MulAdd(c(k), value, estimate);
  }
  for (int k = in.active; k < to_field.bases(); ++k) hn::Store(hn::Zero(d), d, to[k] + i);
  if (in.newborn == 0) return estimate;
  hn::Store(correction, d, to[in.newborn] + i);
  return hn::Add(estimate, correction);
}

void UpdateTile(const UpdateInputs& in, const Tile& tile, const BasisField& from,
                const UpdateOutputs& out) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    load_rows(from, segment, row.from);
    in.coefficients.rows(segment, in.active, row.coefficient);
    in.learning.rows(segment, in.active, row.learning);
    for (int i = 0; i < tile.x1 - tile.x0; i += lanes) {
      const Step step = FindStep(in, segment, i, row);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto load = [&](const Planes<3>& planes) {
          prefetch_below(planes[c], tile.x0 + i, y);
          return hn::LoadU(d, planes[c].row(y) + tile.x0 + i);
        };
        const VF correction = in.correction == nullptr
                                  ? hn::Zero(d)
                                  : hn::IfThenElseZero(step.known, load(*in.correction));
        const VF residual = hn::Sub(load(in.light), hn::Add(load(in.prediction), correction));
        const VF estimate = UpdateBases(in, step, residual, correction, static_cast<int>(c), i,
                                        from, out.bases, row);
        prefetch_below(out.estimate[c], tile.x0 + i, y);
        hn::StoreU(estimate, d, out.estimate[c].row(y) + tile.x0 + i);
      }
    }
    store_rows(row.to, segment, out.bases);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(UpdateTile);

void update_tile(const UpdateInputs& in, const Tile& tile, const BasisField& from,
                 const UpdateOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kCoefficientTile);
  EL_DCHECK(in.active <= from.bases() && in.active <= out.bases.bases() &&
            in.newborn < out.bases.bases());
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(UpdateTile)(in, tile, from, out);
}

}  // namespace eigenlight
#endif
