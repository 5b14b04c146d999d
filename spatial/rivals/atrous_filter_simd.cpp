#include "spatial/rivals/atrous_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/atrous_filter_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/rivals/tap_planes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr float kB3Spline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

// The planes of one row of taps.
struct TapRow {
  TapRows normal, position, color;
  const float* weight;

  TapRow(const AtrousFilterPass& pass, int y)
      : normal(pass.planes, pass.planes.normal, y),
        position(pass.planes, pass.planes.position, y),
        color(pass.planes, pass.light.color, y),
        weight(pass.planes.row(pass.light.weight, y)) {}
};

// A vector of output pixels.
struct Center {
  Vec3<VF16> normal, position, color;
  VF16 normal_scale, position_scale, color_scale;  // of squared distances, in the exponent
};

Center LoadCenter(const AtrousFilterPass& pass, int x, int y) {
  const F16 d;
  const TapRow row(pass, y);
  Center at{row.normal.Load(x), row.position.Load(x), row.color.Load(x), {}, {}, {}};
  const MF16 known = Gt(LoadU(d, row.weight + x), Zero(d));
  at.color_scale = IfThenElseZero(known, Set(d, -pass.inverse_color));
  at.normal_scale = Set(d, -pass.inverse_normal);
  const VF16 depth = LoadU(d, pass.planes.row(pass.planes.depth, y) + x);
  const VF16 sigma = Mul(Set(d, pass.sigma_position), depth);
  at.position_scale = Div(Set(d, -1.0f), Mul(sigma, sigma));
  return at;
}

HWY_INLINE void AddTap(const Center& at, const TapRow& row, int x, float kernel, TapSums& sums) {
  const F16 d;
  const Vec3<VF16> color = row.color.Load(x);
  VF16 exponent = Mul(SquaredDistance(at.position, row.position.Load(x)), at.position_scale);
  exponent = MulAdd(SquaredDistance(at.normal, row.normal.Load(x)), at.normal_scale, exponent);
  exponent = MulAdd(SquaredDistance(at.color, color), at.color_scale, exponent);
  sums.Add(Mul(Exp(d, exponent), Mul(Set(d, kernel), LoadU(d, row.weight + x))), color);
}

// Writes 0 with weight 0 where the pixel is no surface, hence also into the margin on the right.
void StoreMeans(const AtrousFilterPass& pass, const TapSums& sums, int x, int y) {
  const F16 d;
  const MF16 some = sums.HasMean(pass.planes, x, y);
  for (int c = 0; c < 3; ++c) {
    StoreU(IfThenElseZero(some, sums.Mean(c)), d, pass.planes.row(pass.next.color[c], y) + x);
  }
  StoreU(IfThenElseZero(some, Set(d, 1.0f)), d, pass.planes.row(pass.next.weight, y) + x);
}

void FilterTile(const AtrousFilterPass& pass, const Rect& tile) {
  const auto filter = [&](int x, int y) {
    const Center at = LoadCenter(pass, x, y);
    TapSums sums;
    for (int j = 0; j < 5; ++j) {
      const int ty = y + (j - 2) * pass.step;
      if (ty < 0 || ty >= pass.planes.extent().height) continue;
      const TapRow row(pass, ty);
      for (int i = 0; i < 5; ++i) {
        AddTap(at, row, x + (i - 2) * pass.step, kB3Spline[i] * kB3Spline[j], sums);
      }
    }
    StoreMeans(pass, sums, x, y);
  };
  ForEachVector(tile, filter, F16());
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(FilterTile);

void atrous_filter_tile(const AtrousFilterPass& pass, const Rect& tile) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(FilterTile)(pass, tile);
}

}  // namespace eigenlight
#endif
