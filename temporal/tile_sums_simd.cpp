#include <algorithm>

#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/tile_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/tile_sums_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

// One row of a tile: the bases, the residual r = u - V_0 and the weight m of each pixel.
struct Row {
  BasisRows bases;
  alignas(64) float residual[3][kSegment];
  alignas(64) float weight[kSegment];
  int vectors;  // whole vectors of lanes that cover the row
};

// Rec. 709 luminance.
VF Luminance(const VF (&v)[3]) {
  const F d;
  return hn::MulAdd(hn::Set(d, 0.2126f), v[0],
                    hn::MulAdd(hn::Set(d, 0.7152f), v[1], hn::Mul(hn::Set(d, 0.0722f), v[2])));
}

// How many pixels of a row count, and how many of them are off by far more than expected.
struct RowCount {
  std::size_t used = 0, outliers = 0;
};

// Bounded, outliers lose influence.
RowCount LoadRow(const SumInputs& in, const Tile& segment, bool is_bounded, Row& row) {
  const F d;
  load_rows(in.bases, segment, row.bases);
  const int bases = in.bases.bases(), lanes = static_cast<int>(hn::Lanes(d));
  const int count = segment.x1 - segment.x0;
  row.vectors = (count + lanes - 1) / lanes;
  const VF largest = hn::Set(d, kLargestLight), one = hn::Set(d, 1.0f);
  RowCount found;
  for (int i = 0; i < count; i += lanes) {
    VF u[3], v[3], residual[3];
    for (int c = 0; c < 3; ++c) {
      prefetch_below(in.frame.indirect[static_cast<std::size_t>(c)], segment.x0 + i, segment.y0);
      u[c] = hn::LoadU(
          d, in.frame.indirect[static_cast<std::size_t>(c)].row(segment.y0) + segment.x0 + i);
      v[c] = hn::Load(d, row.bases.values[c * bases] + i);
    }
    const VF age = hn::Load(d, row.bases.age + i);
    // Comparisons with NaN are false; the age behind the last pixel is 0.
    const VF luminance = Luminance(v);
    prefetch_below(in.variance, segment.x0 + i, segment.y0);
    const VF variance = hn::LoadU(d, in.variance.row(segment.y0) + segment.x0 + i);
    const VF expected = hn::MulAdd(hn::Mul(hn::Set(d, 0.01f), luminance), luminance, variance);
    auto used = hn::And(hn::Gt(age, hn::Zero(d)), hn::Gt(expected, hn::Set(d, 1e-30f)));
    for (const VF& value : u) used = hn::And(used, hn::Le(hn::Abs(value), largest));
    VF weight = hn::Div(age, hn::Mul(hn::Add(age, one), hn::IfThenElse(used, expected, one)));
    weight = hn::IfThenElseZero(used, weight);
    for (int c = 0; c < 3; ++c) {
      residual[c] = hn::IfThenElseZero(used, hn::Sub(u[c], v[c]));
      hn::Store(residual[c], d, row.residual[c] + i);
    }
    found.used += hn::CountTrue(d, used);
    if (is_bounded) {
      const VF off = Luminance(residual);
      const VF excess =
          hn::Mul(hn::Mul(hn::Mul(weight, off), off), hn::Set(d, 1.0f / (kOutlier * kOutlier)));
      const auto beyond = hn::Gt(excess, one);
      weight = hn::Div(weight, hn::IfThenElse(beyond, excess, one));
      found.outliers += hn::CountTrue(d, beyond);
    }
    hn::Store(weight, d, row.weight + i);
  }
  return found;
}

// sum_c a_c b_c of one vector of pixels; the channels of a and b stand `a_step`, `b_step` apart.
VF DotChannels(const float (*a)[kSegment], int a_step, const float (*b)[kSegment], int b_step) {
  const F d;
  VF sum = hn::Mul(hn::Load(d, a[0]), hn::Load(d, b[0]));
  sum = hn::MulAdd(hn::Load(d, a[a_step]), hn::Load(d, b[b_step]), sum);
  return hn::MulAdd(hn::Load(d, a[2 * a_step]), hn::Load(d, b[2 * b_step]), sum);
}

const float (*Shift(const float (*rows)[kSegment], int i))[kSegment] {
  return reinterpret_cast<const float(*)[kSegment]>(rows[0] + i);
}

void AddRow(const Row& row, int bases, int active, TileSums& sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto total = [&](VF v) { return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v))); };
  const float(*values)[kSegment] = row.bases.values;
  for (int j = 0; j < active; ++j) {
    for (int k = 0; k <= j; ++k) {
      VF sum = hn::Zero(d);
      for (int i = 0; i < row.vectors * lanes; i += lanes) {
        const VF dot = DotChannels(Shift(values + j, i), bases, Shift(values + k, i), bases);
        sum = hn::MulAdd(hn::Load(d, row.weight + i), dot, sum);
      }
      sums.gram[static_cast<std::size_t>(packed(k, j))] += total(sum);
    }
    VF innovation = hn::Zero(d), spread = hn::Zero(d), lean = hn::Zero(d), reach = hn::Zero(d);
    for (int i = 0; i < row.vectors * lanes; i += lanes) {
      const VF weight = hn::Load(d, row.weight + i);
      const VF dot = DotChannels(Shift(values + j, i), bases, Shift(row.residual, i), 1);
      const VF first = DotChannels(Shift(values + j, i), bases, Shift(values, i), bases);
      const VF weighted = hn::Mul(weight, dot), along = hn::Mul(weight, first);
      innovation = hn::Add(innovation, weighted);
      spread = hn::MulAdd(weighted, weighted, spread);
      lean = hn::MulAdd(weighted, along, lean);
      reach = hn::MulAdd(along, along, reach);
    }
    const auto at = static_cast<std::size_t>(j);
    sums.innovation[at] += total(innovation);
    sums.spread[at] += total(spread);
    sums.lean[at] += total(lean);
    sums.reach[at] += total(reach);
  }
}

void AddTile(const SumInputs& in, const Tile& tile, bool is_bounded, TileSums& sums) {
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    const RowCount found = LoadRow(in, segment, is_bounded, row);
    if (found.used == 0) continue;
    sums.pixels += static_cast<double>(found.used);
    sums.outliers += static_cast<double>(found.outliers);
    AddRow(row, in.bases.bases(), std::min(in.active, in.bases.bases()), sums);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(AddTile);

void accumulate_tile(const SumInputs& in, const Tile& tile, TileSums& sums) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(AddTile)(in, tile, true, sums);
}

void admit_outliers(const SumInputs& in, const Tile& tile, TileSums& sums) {
  if (8.0 * sums.outliers <= sums.pixels) return;
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  sums = {};
  HWY_DYNAMIC_DISPATCH(AddTile)(in, tile, false, sums);
}

TileSums& TileSums::operator+=(const TileSums& other) {
  const auto add = [](auto& to, const auto& from) {
    std::transform(to.begin(), to.end(), from.begin(), to.begin(), std::plus<>());
  };
  add(gram, other.gram);
  add(innovation, other.innovation);
  add(spread, other.spread);
  add(lean, other.lean);
  add(reach, other.reach);
  pixels += other.pixels;
  outliers += other.outliers;
  return *this;
}

double TileSums::scatter(std::size_t i, double delta) const {
  const double freedom = 1.0 - 3.0 * reach[0] / (gram[0] * gram[0]);
  if (!(freedom > 0.0)) return spread[i];
  // The terms cancel where the gain explains all: rounding may leave less than nothing.
  return std::max(spread[i] + delta * (delta * reach[i] - 2.0 * lean[i]), 0.0) / freedom;
}

}  // namespace eigenlight
#endif
