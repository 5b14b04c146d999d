#include <algorithm>
#include <cmath>

#include "frame/float_traps.h"
#include "frame/usable_surface.h"
#include "temporal/baselines/svgf_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/baselines/svgf_filter_simd.cpp"
// The order matters: foreach_target first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

constexpr int kWidth = 64;  // widest tile
constexpr float kSpline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

VF Luminance(VF r, VF g, VF b) {
  const F d;
  return hn::MulAdd(hn::Set(d, 0.2126f), r,
                    hn::MulAdd(hn::Set(d, 0.7152f), g, hn::Mul(hn::Set(d, 0.0722f), b)));
}

// Variance around the pixels [x0, x0 + count) of row y: 3 x 3 binomial, edges repeated.
void SmoothVariance(const Plane<float>& variance, int x0, int count, int y, float* out) {
  const float* upper = variance.row(std::max(y - 1, 0));
  const float* middle = variance.row(y);
  const float* lower = variance.row(std::min(y + 1, variance.height() - 1));
  float column[kWidth + 2];
  for (int i = -1; i <= count; ++i) {
    const int x = std::clamp(x0 + i, 0, variance.width() - 1);
    column[i + 1] = upper[x] + 2.0f * middle[x] + lower[x];
  }
  for (int i = 0; i < count; ++i) {
    out[i] = (column[i] + 2.0f * column[i + 1] + column[i + 2]) * (1.0f / 16.0f);
  }
}

// The planes of one row of taps, and what is loaded of them.
struct TapRow {
  const float *color[3], *variance, *normal[3], *depth, *known;

  TapRow(const SvgfPass& pass, const SvgfImage& in, int y)
      : color{in.color[0].row(y), in.color[1].row(y), in.color[2].row(y)},
        variance(in.variance.row(y)),
        normal{pass.guides.surface.normal[0].row(y), pass.guides.surface.normal[1].row(y),
               pass.guides.surface.normal[2].row(y)},
        depth(pass.guides.surface.depth.row(y)),
        known(pass.known.row(y)) {}
};

// What a vector of output pixels compares its neighbors with, and what it has gathered of them.
struct Center {
  VF normal[3], depth, slope_x, slope_y, depth_epsilon;
  VF luminance, luminance_scale;
  VF sum[3], weight, variance;
};

Center LoadCenter(const SvgfPass& pass, const TapRow& row, int x, int y, VF smooth_variance) {
  const F d;
  const Camera& camera = pass.guides.camera;
  const glm::mat3& to_view = camera.world_to_view;
  Center at;
  for (int c = 0; c < 3; ++c) at.normal[c] = hn::LoadU(d, row.normal[c] + x);
  const auto view_normal = [&](int r) {
    VF v = hn::Mul(hn::Set(d, to_view[0][r]), at.normal[0]);
    v = hn::MulAdd(hn::Set(d, to_view[1][r]), at.normal[1], v);
    return hn::MulAdd(hn::Set(d, to_view[2][r]), at.normal[2], v);
  };
  // z = plane / (N . ray), so dz/dx = -z N_x / (focal N . ray); its sign never matters.
  const VF nx = view_normal(0), ny = view_normal(1), nz = view_normal(2);
  const VF inverse_focal = hn::Set(d, 1.0f / camera.focal);
  const VF ray_x =
      hn::Mul(hn::Sub(hn::Iota(d, static_cast<float>(x) + 0.5f), hn::Set(d, camera.center.x)),
              inverse_focal);
  const float ray_y = (static_cast<float>(y) + 0.5f - camera.center.y) / camera.focal;
  const VF along = hn::Abs(hn::MulAdd(nx, ray_x, hn::MulAdd(ny, hn::Set(d, ray_y), nz)));
  at.depth = hn::LoadU(d, row.depth + x);
  // Seen from the edge a plane has any slope; 1e-3 bounds it.
  const VF scale = hn::Div(hn::Mul(at.depth, inverse_focal), hn::Max(along, hn::Set(d, 1e-3f)));
  const VF sigma = hn::Set(d, pass.weights.depth_slopes);
  at.slope_x = hn::Mul(hn::Mul(nx, scale), sigma);
  at.slope_y = hn::Mul(hn::Mul(ny, scale), sigma);
  // A depth that is none must not turn the decay into a growth.
  at.depth_epsilon = hn::Mul(hn::Max(at.depth, hn::Zero(d)), hn::Set(d, 1e-3f));

  const VF color[3] = {hn::LoadU(d, row.color[0] + x), hn::LoadU(d, row.color[1] + x),
                       hn::LoadU(d, row.color[2] + x)};
  at.luminance = Luminance(color[0], color[1], color[2]);
  const VF tolerance =
      hn::MulAdd(hn::Set(d, pass.weights.luminance_sigmas), hn::Sqrt(smooth_variance),
                 hn::Mul(hn::Set(d, 1e-4f), hn::Abs(at.luminance)));
  // 1e-20 only keeps black on black from dividing by zero.
  at.luminance_scale = hn::Div(hn::Set(d, 1.0f), hn::Add(tolerance, hn::Set(d, 1e-20f)));

  // The center tap always counts, whatever its normal.
  const VF own = hn::Set(d, kSpline[2] * kSpline[2]);
  for (int c = 0; c < 3; ++c) at.sum[c] = hn::Mul(own, color[c]);
  at.weight = own;
  at.variance = hn::Mul(hn::Mul(own, own), hn::LoadU(d, row.variance + x));
  return at;
}

// Adds the taps that `load` fetches, `offset` pixels away, to the center.
template <typename Load>
HWY_INLINE void AddTap(const SvgfPass& pass, const TapRow& row, glm::vec2 offset, VF kernel,
                       Load load, Center& at) {
  const F d;
  const VF slope = hn::Abs(
      hn::MulAdd(at.slope_x, hn::Set(d, offset.x), hn::Mul(at.slope_y, hn::Set(d, offset.y))));
  const VF apart =
      hn::Div(hn::Abs(hn::Sub(load(row.depth), at.depth)), hn::Add(slope, at.depth_epsilon));
  const VF r = load(row.color[0]), g = load(row.color[1]), b = load(row.color[2]);
  const VF light = hn::Abs(hn::Sub(Luminance(r, g, b), at.luminance));
  VF cosine = hn::Mul(at.normal[0], load(row.normal[0]));
  cosine = hn::MulAdd(at.normal[1], load(row.normal[1]), cosine);
  cosine = hn::MulAdd(at.normal[2], load(row.normal[2]), cosine);
  // Normals that are no unit vectors would have powers without bound.
  const auto unit =
      hn::And(hn::Gt(cosine, hn::Zero(d)), hn::Le(cosine, hn::Set(d, kLargestCosine)));
  const auto valid = hn::And(hn::Gt(load(row.known), hn::Zero(d)), unit);
  for (int s = 0; s < pass.weights.normal_squarings; ++s) cosine = hn::Mul(cosine, cosine);
  const VF decay = hn::Exp(d, hn::Neg(hn::MulAdd(light, at.luminance_scale, apart)));
  // Where nothing is seen depths are infinite and the product is NaN.
  const VF w = hn::IfThenElseZero(valid, hn::Mul(hn::Mul(cosine, decay), kernel));
  at.sum[0] = hn::MulAdd(w, r, at.sum[0]);
  at.sum[1] = hn::MulAdd(w, g, at.sum[1]);
  at.sum[2] = hn::MulAdd(w, b, at.sum[2]);
  at.weight = hn::Add(at.weight, w);
  at.variance = hn::MulAdd(hn::Mul(w, w), load(row.variance), at.variance);
}

// A row of taps for the pixels x .. x + lanes; where some lie outside the image, kernel 0 there.
void AddRow(const SvgfPass& pass, const TapRow& row, int x, int dy, Center& at) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), last = pass.known.width() - 1;
  const float down = static_cast<float>(dy * pass.step);
  alignas(HWY_MAX_BYTES) float values[HWY_MAX_BYTES / sizeof(float)];
  for (int dx = -2; dx <= 2; ++dx) {
    if (dx == 0 && dy == 0) continue;
    const int first = x + dx * pass.step;
    const glm::vec2 offset(static_cast<float>(dx * pass.step), down);
    const VF kernel = hn::Set(d, kSpline[dx + 2] * kSpline[dy + 2]);
    if (first >= 0 && first + lanes <= pass.known.width()) {
      const auto load = [&](const float* source) { return hn::LoadU(d, source + first); };
      AddTap(pass, row, offset, kernel, load, at);
      continue;
    }
    const auto load = [&](const float* source) {
      for (int l = 0; l < lanes; ++l) values[l] = source[std::clamp(first + l, 0, last)];
      return hn::Load(d, values);
    };
    const VF column = hn::Iota(d, static_cast<float>(first));
    const auto inside =
        hn::And(hn::Ge(column, hn::Zero(d)), hn::Le(column, hn::Set(d, static_cast<float>(last))));
    AddTap(pass, row, offset, hn::IfThenElseZero(inside, kernel), load, at);
  }
}

void PassTile(const SvgfPass& pass, const SvgfImage& in, const Rect& tile, SvgfImage& out) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  alignas(HWY_MAX_BYTES) float smooth_variance[kWidth + HWY_MAX_BYTES / sizeof(float)] = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    const TapRow own(pass, in, y);
    SmoothVariance(in.variance, tile.x0, tile.x1 - tile.x0, y, smooth_variance);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Center at = LoadCenter(pass, own, x, y, hn::LoadU(d, smooth_variance + (x - tile.x0)));
      for (int dy = -2; dy <= 2; ++dy) {
        const int ty = y + dy * pass.step;
        if (ty < 0 || ty >= pass.known.height()) continue;
        AddRow(pass, TapRow(pass, in, ty), x, dy, at);
      }
      // Lanes beyond the row write its padding.
      const auto known = hn::Gt(hn::LoadU(d, own.known + x), hn::Zero(d));
      const VF scale = hn::Div(hn::Set(d, 1.0f), at.weight);
      for (std::size_t c = 0; c < 3; ++c) {
        hn::StoreU(hn::IfThenElseZero(known, hn::Mul(at.sum[c], scale)), d,
                   out.color[c].row(y) + x);
      }
      hn::StoreU(hn::IfThenElseZero(known, hn::Mul(at.variance, hn::Mul(scale, scale))), d,
                 out.variance.row(y) + x);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(PassTile);

void svgf_pass_tile(const SvgfPass& pass, const SvgfImage& in, const Rect& tile, SvgfImage& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= 64);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(PassTile)(pass, in, tile, out);
}

}  // namespace eigenlight
#endif
