#include <algorithm>

#include "temporal/bases/tile_sums.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/tile_sums_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// A vector of pixels in the block of its bases.
struct Block {
  const BasisField& field;
  const float* at;

  [[nodiscard]] HWY_INLINE VF3 Basis(int k) const {
    const auto load = [&](int c) { return Load(F(), at + kBlock * field.line_of(c, k)); };
    return {{load(0), load(1), load(2)}};
  }
};

// What a vector of pixels brings: the residual r = u - V_0, the weight m of each pixel, how many
// count, and how many of them are off by far more than expected.
struct Pixels {
  VF3 residual;
  VF weight;
  int used = 0, outliers = 0;
};

// Bounded, outliers lose influence.
Pixels LoadPixels(const SumInputs& in, const Block& block, int x, int y, bool is_bounded) {
  const VF one = Set(1);
  const VF3 light = LoadAndPrefetch(in.light, x, y), first = block.Basis(0);
  const VF age = Load(F(), in.bases.ages(x, y)), luminance = Luminance(first);
  const VF variance = LoadAndPrefetch(in.variance, x, y);
  const VF expected = MulAdd(Mul(Set(0.01f), luminance), luminance, variance);
  // Comparisons with NaN are false; the age behind the last pixel is 0.
  MF used = And(Gt(age, Zero()), Gt(expected, Set(1e-30f)));
  for (int c = 0; c < 3; ++c) used = And(used, Le(Abs(light[c]), Set(kLargestLight)));
  Pixels pixels;
  for (int c = 0; c < 3; ++c) {
    pixels.residual[c] = IfThenElseZero(used, Sub(light[c], first[c]));
  }
  pixels.used = CountLanes(used);
  const VF weight = Div(age, Mul(Add(age, one), IfThenElse(used, expected, one)));
  pixels.weight = IfThenElseZero(used, weight);
  if (is_bounded) {
    const VF off = Luminance(pixels.residual);
    const VF square = Mul(Mul(pixels.weight, off), off);
    const VF excess = Mul(square, Set(1.0f / (kOutlier * kOutlier)));
    const MF beyond = Gt(excess, one);
    pixels.weight = Div(pixels.weight, IfThenElse(beyond, excess, one));
    pixels.outliers = CountLanes(beyond);
  }
  return pixels;
}

// Sums of a few rows, lane by lane; those of TileSums.
struct LaneSums {
  VF gram[kMaxBases * (kMaxBases + 1) / 2];
  VF innovation[kMaxBases], scatter_rr[kMaxBases], scatter_r0[kMaxBases], scatter_00[kMaxBases];
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
    visit(lanes.scatter_rr[j], sums.scatter_rr[at]);
    visit(lanes.scatter_r0[j], sums.scatter_r0[at]);
    visit(lanes.scatter_00[j], sums.scatter_00[at]);
  }
}

void AddPixels(const Pixels& pixels, const Block& block, int active, LaneSums& sums) {
  const VF3 steady = block.Basis(0);
  for (int j = 0; j < active; ++j) {
    VF3 own = block.Basis(j);
    for (int c = 0; c < 3; ++c) own[c] = Mul(pixels.weight, own[c]);
    const VF weighted = DotInOrder(own, pixels.residual), along = DotInOrder(own, steady);
    const auto add = [](VF value, VF& sum) { sum = Add(sum, value); };
    const auto add_product = [](VF a, VF b, VF& sum) { sum = MulAdd(a, b, sum); };
    add(weighted, sums.innovation[j]);
    add_product(weighted, weighted, sums.scatter_rr[j]);
    add_product(weighted, along, sums.scatter_r0[j]);
    add_product(along, along, sums.scatter_00[j]);
    add(along, sums.gram[packed(0, j)]);
    for (int k = 1; k <= j; ++k) {
      add(DotInOrder(own, block.Basis(k)), sums.gram[packed(k, j)]);
    }
  }
}

void AddRows(const SumInputs& in, const Rect& rows, bool is_bounded, TileSums& sums) {
  const int active = std::min(in.active, in.bases.bases());
  LaneSums lanes;
  ForEachSum(active, lanes, sums, [](VF& lane, double&) { lane = Zero(F()); });
  int used = 0, outliers = 0;
  for (int y = rows.y0; y < rows.y1; ++y) {
    for (int x = rows.x0; x < rows.x1; x += LaneCount()) {
      const Block block{in.bases, in.bases.at(x, y)};
      const Pixels pixels = LoadPixels(in, block, x, y, is_bounded);
      if (pixels.used == 0) continue;
      used += pixels.used;
      outliers += pixels.outliers;
      AddPixels(pixels, block, active, lanes);
    }
  }
  if (used == 0) return;
  sums.pixels += static_cast<double>(used);
  sums.outliers += static_cast<double>(outliers);
  ForEachSum(active, lanes, sums, [](VF& lane, double& sum) { sum += SumLanes(lane); });
}

void AddTile(const SumInputs& in, const Rect& tile, bool is_bounded, TileSums& sums) {
  for (int y = tile.y0; y < tile.y1; y += kSumRows) {
    AddRows(in, {tile.x0, y, tile.x1, std::min(y + kSumRows, tile.y1)}, is_bounded, sums);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(AddTile);

void accumulate_tile(const SumInputs& in, const Rect& tile, TileSums& sums) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(AddTile)(in, tile, true, sums);
}

void admit_outliers(const SumInputs& in, const Rect& tile, TileSums& sums) {
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
  add(scatter_rr, other.scatter_rr);
  add(scatter_r0, other.scatter_r0);
  add(scatter_00, other.scatter_00);
  pixels += other.pixels;
  outliers += other.outliers;
  return *this;
}

double TileSums::innovation_variance(std::size_t i, double delta) const {
  const double freedom = 1.0 - 3.0 * scatter_00[0] / (gram[0] * gram[0]);
  if (!(freedom > 0.0)) return scatter_rr[i];
  // The terms cancel where the gain explains all: rounding may leave less than nothing.
  return std::max(scatter_rr[i] + delta * (delta * scatter_00[i] - 2.0 * scatter_r0[i]), 0.0) /
         freedom;
}

}  // namespace eigenlight
#endif
