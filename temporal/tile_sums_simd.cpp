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

// One row of a tile: the residual r = u - V_0 and the weight m of each pixel.
struct Row {
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

// The vector of basis k that begins at pixel i of a segment.
void Load(const BasisField& bases, const Tile& segment, int k, int i, VF (&v)[3]) {
  const float* block = bases.at(segment.x0 + i, segment.y0);
  for (int c = 0; c < 3; ++c) v[c] = hn::Load(F(), block + kBlock * bases.line_of(c, k));
}

// How many pixels of a row count, and how many of them are off by far more than expected.
struct RowCount {
  std::size_t used = 0, outliers = 0;
};

// Bounded, outliers lose influence.
RowCount LoadRow(const SumInputs& in, const Tile& segment, bool is_bounded, Row& row) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), count = segment.x1 - segment.x0;
  row.vectors = (count + lanes - 1) / lanes;
  const VF largest = hn::Set(d, kLargestLight), one = hn::Set(d, 1.0f);
  RowCount found;
  for (int i = 0; i < count; i += lanes) {
    VF u[3], v[3], residual[3];
    for (int c = 0; c < 3; ++c) {
      prefetch_below(in.frame.indirect[static_cast<std::size_t>(c)], segment.x0 + i, segment.y0);
      u[c] = hn::LoadU(
          d, in.frame.indirect[static_cast<std::size_t>(c)].row(segment.y0) + segment.x0 + i);
    }
    Load(in.bases, segment, 0, i, v);
    const VF age =
        hn::Load(d, in.bases.at(segment.x0 + i, segment.y0) + kBlock * 3 * in.bases.bases());
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

// sum_c a_c b_c of one vector of pixels.
VF Dot(const VF (&a)[3], const VF (&b)[3]) {
  return hn::MulAdd(a[2], b[2], hn::MulAdd(a[1], b[1], hn::Mul(a[0], b[0])));
}

// Sums of a few rows, lane by lane; those of TileSums.
struct LaneSums {
  VF gram[kMaxBases * (kMaxBases + 1) / 2];
  VF innovation[kMaxBases], spread[kMaxBases], lean[kMaxBases], reach[kMaxBases];
};

// Calls visit(lane sum, sum) for all of `active` bases.
template <typename Visit>
void ForEachSum(int active, LaneSums& lanes, TileSums& sums, const Visit& visit) {
  for (int j = 0; j < active; ++j) {
    const auto at = static_cast<std::size_t>(j);
    for (int k = 0; k <= j; ++k) {
      visit(lanes.gram[packed(k, j)], sums.gram[static_cast<std::size_t>(packed(k, j))]);
    }
    visit(lanes.innovation[j], sums.innovation[at]);
    visit(lanes.spread[j], sums.spread[at]);
    visit(lanes.lean[j], sums.lean[at]);
    visit(lanes.reach[j], sums.reach[at]);
  }
}

// Products of basis j with those from the second on, up to itself.
void AddGram(const BasisField& bases, const Tile& segment, const Row& row, int j, LaneSums& sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int k = 1; k <= j; ++k) {
    VF sum = sums.gram[packed(k, j)];
    for (int i = 0; i < row.vectors * lanes; i += lanes) {
      VF a[3], b[3];
      Load(bases, segment, j, i, a);
      Load(bases, segment, k, i, b);
      sum = hn::MulAdd(hn::Load(d, row.weight + i), Dot(a, b), sum);
    }
    sums.gram[packed(k, j)] = sum;
  }
}

// Products of basis j with the first and with the residual, and what tells their noise.
void AddInnovation(const BasisField& bases, const Tile& segment, const Row& row, int j,
                   LaneSums& sums) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  VF gram = sums.gram[packed(0, j)], innovation = sums.innovation[j];
  VF spread = sums.spread[j], lean = sums.lean[j], reach = sums.reach[j];
  for (int i = 0; i < row.vectors * lanes; i += lanes) {
    VF own[3], steady[3], residual[3];
    Load(bases, segment, j, i, own);
    Load(bases, segment, 0, i, steady);
    for (int c = 0; c < 3; ++c) residual[c] = hn::Load(d, row.residual[c] + i);
    const VF weight = hn::Load(d, row.weight + i);
    const VF weighted = hn::Mul(weight, Dot(own, residual));
    const VF along = hn::Mul(weight, Dot(own, steady));
    gram = hn::Add(gram, along);
    innovation = hn::Add(innovation, weighted);
    spread = hn::MulAdd(weighted, weighted, spread);
    lean = hn::MulAdd(weighted, along, lean);
    reach = hn::MulAdd(along, along, reach);
  }
  sums.gram[packed(0, j)] = gram;
  sums.innovation[j] = innovation;
  sums.spread[j] = spread;
  sums.lean[j] = lean;
  sums.reach[j] = reach;
}

void AddRows(const SumInputs& in, const Tile& rows, bool is_bounded, TileSums& sums) {
  const int active = std::min(in.active, in.bases.bases());
  LaneSums lanes;
  ForEachSum(active, lanes, sums, [](VF& lane, double&) { lane = hn::Zero(F()); });
  Row row;
  std::size_t used = 0;
  for (int y = rows.y0; y < rows.y1; ++y) {
    const Tile segment{rows.x0, y, rows.x1, y + 1, rows.index};
    const RowCount found = LoadRow(in, segment, is_bounded, row);
    if (found.used == 0) continue;
    used += found.used;
    sums.outliers += static_cast<double>(found.outliers);
    for (int j = 0; j < active; ++j) {
      AddInnovation(in.bases, segment, row, j, lanes);
      AddGram(in.bases, segment, row, j, lanes);
    }
  }
  if (used == 0) return;
  sums.pixels += static_cast<double>(used);
  ForEachSum(active, lanes, sums, [](VF& lane, double& sum) {
    sum += static_cast<double>(hn::GetLane(hn::SumOfLanes(F(), lane)));
  });
}

void AddTile(const SumInputs& in, const Tile& tile, bool is_bounded, TileSums& sums) {
  for (int y = tile.y0; y < tile.y1; y += kSumRows) {
    AddRows(in, {tile.x0, y, tile.x1, std::min(y + kSumRows, tile.y1), tile.index}, is_bounded,
            sums);
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
