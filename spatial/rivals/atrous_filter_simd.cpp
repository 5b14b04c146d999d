#include "frame/float_traps.h"
#include "spatial/rivals/atrous_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/atrous_filter_simd.cpp"
// Not in alphabetical order: foreach_target.h has to come first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

constexpr float kB3Spline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

// The planes of one row of taps, at column 0.
struct TapRow {
  const float *normal[3], *position[3], *color[3], *weight;

  TapRow(const AtrousFilterPass& pass, int y) : weight(pass.planes.row(pass.light.weight, y)) {
    for (std::size_t c = 0; c < 3; ++c) {
      normal[c] = pass.planes.row(pass.planes.normal[c], y);
      position[c] = pass.planes.row(pass.planes.position[c], y);
      color[c] = pass.planes.row(pass.light.color[c], y);
    }
  }
};

struct Center {
  VF normal[3], position[3], color[3];
  VF normal_scale, position_scale, color_scale;  // of squared distances, in the exponent
};

struct Sums {
  VF color[3], weight;
};

Center LoadCenter(const AtrousFilterPass& pass, int x, int y) {
  const F d;
  const TapRow row(pass, y);
  Center at;
  for (int c = 0; c < 3; ++c) {
    at.normal[c] = hn::LoadU(d, row.normal[c] + x);
    at.position[c] = hn::LoadU(d, row.position[c] + x);
    at.color[c] = hn::LoadU(d, row.color[c] + x);
  }
  const auto known = hn::Gt(hn::LoadU(d, row.weight + x), hn::Zero(d));
  at.color_scale = hn::IfThenElseZero(known, hn::Set(d, -pass.inverse_color));
  at.normal_scale = hn::Set(d, -pass.inverse_normal);
  const VF sigma = hn::Mul(hn::Set(d, pass.sigma_position),
                           hn::LoadU(d, pass.planes.row(pass.planes.depth, y) + x));
  at.position_scale = hn::Div(hn::Set(d, -1.0f), hn::Mul(sigma, sigma));
  return at;
}

HWY_INLINE void AddTap(const Center& at, const TapRow& row, int x, float kernel, Sums& sums) {
  const F d;
  const auto load = [&](const float* plane) { return hn::LoadU(d, plane + x); };
  const auto square = [&](const VF(&a)[3], const float* const(&b)[3]) {
    const VF u = hn::Sub(a[0], load(b[0])), v = hn::Sub(a[1], load(b[1]));
    const VF w = hn::Sub(a[2], load(b[2]));
    return hn::MulAdd(u, u, hn::MulAdd(v, v, hn::Mul(w, w)));
  };
  VF exponent = hn::Mul(square(at.position, row.position), at.position_scale);
  exponent = hn::MulAdd(square(at.normal, row.normal), at.normal_scale, exponent);
  exponent = hn::MulAdd(square(at.color, row.color), at.color_scale, exponent);
  const VF w = hn::Mul(hn::Exp(d, exponent), hn::Mul(hn::Set(d, kernel), load(row.weight)));
  for (int c = 0; c < 3; ++c) sums.color[c] = hn::MulAdd(w, load(row.color[c]), sums.color[c]);
  sums.weight = hn::Add(sums.weight, w);
}

// Writes 0 with weight 0 where the pixel is no surface, hence also into the margin on the right.
void StoreMeans(const AtrousFilterPass& pass, const Sums& sums, int x, int y) {
  const F d;
  const VF surface = hn::LoadU(d, pass.planes.row(pass.planes.surface, y) + x);
  const auto some = hn::And(hn::Gt(surface, hn::Zero(d)), hn::Gt(sums.weight, hn::Zero(d)));
  for (std::size_t c = 0; c < 3; ++c) {
    const VF mean = hn::Div(sums.color[c], sums.weight);
    hn::StoreU(hn::IfThenElseZero(some, mean), d, pass.planes.row(pass.next.color[c], y) + x);
  }
  hn::StoreU(hn::IfThenElseZero(some, hn::Set(d, 1.0f)), d,
             pass.planes.row(pass.next.weight, y) + x);
}

void FilterTile(const AtrousFilterPass& pass, const Rect& tile) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), height = pass.planes.extent().height;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      const Center at = LoadCenter(pass, x, y);
      Sums sums{{hn::Zero(d), hn::Zero(d), hn::Zero(d)}, hn::Zero(d)};
      for (int j = 0; j < 5; ++j) {
        const int ty = y + (j - 2) * pass.step;
        if (ty < 0 || ty >= height) continue;
        const TapRow row(pass, ty);
        for (int i = 0; i < 5; ++i) {
          AddTap(at, row, x + (i - 2) * pass.step, kB3Spline[i] * kB3Spline[j], sums);
        }
      }
      StoreMeans(pass, sums, x, y);
    }
  }
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
