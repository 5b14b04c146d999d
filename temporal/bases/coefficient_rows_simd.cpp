#include <algorithm>
#include <array>
#include <cmath>

#include "temporal/bases/coefficients.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/bases/coefficient_rows_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr int kHalf = kCoefficientTile / 2;
// A vector never reaches across the middle of a tile.
using Half = hn::CappedTag<float, kHalf>;

// How far a pixel's center is from the middle of its tile, in tiles: the weight of the neighbor on
// its side.
struct NeighborWeights {
  alignas(64) std::array<float, kCoefficientTile> at{};

  constexpr NeighborWeights() {
    for (int i = 0; i < kCoefficientTile; ++i) {
      const float off = (static_cast<float>(i) + 0.5f) / kCoefficientTile - 0.5f;
      at[static_cast<std::size_t>(i)] = off < 0.0f ? -off : off;
    }
  }
};
constexpr NeighborWeights kNeighbor;

// The two tile rows around a row of pixels, blended, of all bases: in the tile's own column, and
// how much more its neighbors have.
struct Blend {
  alignas(64) float own[kMaxBases], left[kMaxBases], right[kMaxBases];

  Blend(const float* const (&upper)[3], const float* const (&lower)[3], float weight) {
    const hn::CappedTag<float, kMaxBases> d;
    for (int k = 0; k < kMaxBases; k += LaneCount(d)) {
      const auto blend = [&](int column) {
        const auto from = LoadU(d, upper[column] + k);
        const auto step = Sub(LoadU(d, lower[column] + k), from);
        return MulAdd(Set(d, weight), step, from);
      };
      const auto middle = blend(1);
      Store(middle, d, own + k);
      Store(Sub(blend(0), middle), d, left + k);
      Store(Sub(blend(2), middle), d, right + k);
    }
    own[0] += 1.0f;
  }
};

void FillRow(float own, float left, float right, float* out) {
  const Half d;
  for (int i = 0; i < kCoefficientTile; i += LaneCount(d)) {
    const auto step = Set(d, i < kHalf ? left : right);
    Store(MulAdd(Load(d, kNeighbor.at.data() + i), step, Set(d, own)), d, out + i);
  }
}

void FillRows(const CoefficientField& field, const Rect& row, int count, CoefficientRows& out) {
  const TileGrid& grid = field.grid();
  const float ty = (static_cast<float>(row.y0) + 0.5f) / kCoefficientTile - 0.5f;
  const int y0 = std::clamp(static_cast<int>(std::floor(ty)), 0, grid.rows() - 1);
  const int y1 = std::min(y0 + 1, grid.rows() - 1);
  const float fy = std::clamp(ty - static_cast<float>(y0), 0.0f, 1.0f);
  const float *upper[3], *lower[3];
  for (int i = 0; i < 3; ++i) {
    const int x = std::clamp(row.x0 / kCoefficientTile + i - 1, 0, grid.columns() - 1);
    upper[i] = field.tile(y0 * grid.columns() + x).data();
    lower[i] = field.tile(y1 * grid.columns() + x).data();
  }
  const Blend blend(upper, lower, fy);
  for (int k = 0; k < count; ++k) {
    FillRow(blend.own[k], blend.left[k], blend.right[k], out.values[k]);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(FillRows);

void CoefficientField::rows(const Rect& row, int count, CoefficientRows& out) const {
  EL_DCHECK(row.x0 % kCoefficientTile == 0 && row.x1 - row.x0 <= kCoefficientTile);
  EL_DCHECK(count >= 0 && count <= bases_);
  HWY_DYNAMIC_DISPATCH(FillRows)(*this, row, count, out);
}

}  // namespace eigenlight
#endif
