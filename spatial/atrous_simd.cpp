#include <algorithm>
#include <cmath>

#include "frame/float_traps.h"
#include "frame/usable_surface.h"
#include "spatial/atrous_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/atrous_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;
using Line = float[kAtrousWidth];

// Taps -2 .. 2 by radius: none, binomial, B3-spline.
constexpr float kKernel[3][5] = {{0.0f, 0.0f, 1.0f, 0.0f, 0.0f},
                                 {0.0f, 1.0f / 4, 1.0f / 2, 1.0f / 4, 0.0f},
                                 {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16}};

float Weight(const AtrousPass& pass, int dx, int dy) {
  const float* kernel = kKernel[pass.options.radius] + 2;
  return kernel[dx] * kernel[dy];
}

VF Luminance(VF r, VF g, VF b) {
  const F d;
  return hn::MulAdd(hn::Set(d, 0.2126f), r,
                    hn::MulAdd(hn::Set(d, 0.7152f), g, hn::Mul(hn::Set(d, 0.0722f), b)));
}

// Variance of luminance around the pixels [x0, x0 + count) of row y: 3 x 3 binomial, edges
// repeated.
void SmoothVariance(const Plane<float>& variance, int x0, int count, int y, float* out) {
  const float* upper = variance.row(std::max(y - 1, 0));
  const float* middle = variance.row(y);
  const float* lower = variance.row(std::min(y + 1, variance.height() - 1));
  float column[kAtrousWidth + 2];
  const auto sum = [&](int x) { return upper[x] + 2.0f * middle[x] + lower[x]; };
  if (x0 > 0 && x0 + count < variance.width()) {
    const F d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const VF two = hn::Set(d, 2.0f), scale = hn::Set(d, 1.0f / 16.0f);
    const auto vector = [&](int x) {
      return hn::MulAdd(two, hn::LoadU(d, middle + x),
                        hn::Add(hn::LoadU(d, upper + x), hn::LoadU(d, lower + x)));
    };
    for (int i = 0; i < count; i += lanes) {
      const int x = x0 + i;
      const VF sides = hn::Add(vector(x - 1), vector(x + 1));
      hn::Store(hn::Mul(scale, hn::MulAdd(two, vector(x), sides)), d, out + i);
    }
    return;
  }
  column[0] = sum(std::max(x0 - 1, 0));
  for (int i = 0; i < count; ++i) column[i + 1] = sum(x0 + i);
  column[count + 1] = sum(std::min(x0 + count, variance.width() - 1));
  for (int i = 0; i < count; ++i) {
    out[i] = (column[i] + 2.0f * column[i + 1] + column[i + 2]) * (1.0f / 16.0f);
  }
}

// What a vector of output pixels compares its neighbors with, and what it has gathered of them.
struct Center {
  VF normal[3];
  VF plane_x, plane_y, plane_c;  // N . ray(x, y) = plane_x x + plane_y y + plane_c
  VF plane;                      // N . (X - eye)
  VF plane_scale;                // 1 / (8 plane_distance depth)
  VF luminance;
  VF luminance_scale;  // 1 / (8 (sigmas sigma + 1e-4 luminance))
  VF sum[3], weight, variance;
};

template <bool kLight>
HWY_INLINE Center LoadCenter(const AtrousPass& pass, int x, int y, VF smooth_variance) {
  const F d;
  const Camera& camera = pass.guides.camera;
  const glm::mat3& to_view = camera.world_to_view;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  Center at;
  for (std::size_t c = 0; c < 3; ++c) at.normal[c] = load(pass.guides.surface.normal[c]);
  const auto view_normal = [&](int r) {
    VF v = hn::Mul(hn::Set(d, to_view[0][r]), at.normal[0]);
    v = hn::MulAdd(hn::Set(d, to_view[1][r]), at.normal[1], v);
    return hn::MulAdd(hn::Set(d, to_view[2][r]), at.normal[2], v);
  };
  const VF inverse_focal = hn::Set(d, 1.0f / camera.focal);
  at.plane_x = hn::Mul(view_normal(0), inverse_focal);
  at.plane_y = hn::Mul(view_normal(1), inverse_focal);
  at.plane_c =
      hn::NegMulAdd(at.plane_x, hn::Set(d, camera.center.x - 0.5f),
                    hn::NegMulAdd(at.plane_y, hn::Set(d, camera.center.y - 0.5f), view_normal(2)));
  const VF depth = load(pass.guides.surface.depth);
  const VF column = hn::Iota(d, static_cast<float>(x));
  const VF line = hn::Set(d, static_cast<float>(y));
  at.plane =
      hn::Mul(depth, hn::MulAdd(at.plane_x, column, hn::MulAdd(at.plane_y, line, at.plane_c)));
  // A depth that is none must not turn the decay into a growth: it leaves no valid tap.
  const VF distance = hn::Mul(hn::Set(d, pass.options.plane_distance), depth);
  at.plane_scale = hn::Div(hn::Set(d, 0.125f), hn::Max(distance, hn::Zero(d)));

  const VF color[3] = {load(pass.color[0]), load(pass.color[1]), load(pass.color[2])};
  if constexpr (kLight) {
    at.luminance = Luminance(color[0], color[1], color[2]);
    const VF tolerance =
        hn::MulAdd(hn::Set(d, pass.options.luminance_sigmas), hn::Sqrt(smooth_variance),
                   hn::Mul(hn::Set(d, 1e-4f), hn::Abs(at.luminance)));
    // 1e-20 only keeps black on black from dividing by zero.
    at.luminance_scale = hn::Div(hn::Set(d, 0.125f), hn::Add(tolerance, hn::Set(d, 1e-20f)));
  }

  // The center tap always counts, whatever its normal.
  const VF own = hn::Set(d, Weight(pass, 0, 0));
  for (int c = 0; c < 3; ++c) at.sum[c] = hn::Mul(own, color[c]);
  at.weight = own;
  at.variance = hn::Mul(hn::Mul(own, own), load(pass.variance));
  return at;
}

// The planes of one row of taps.
struct TapRow {
  const float *color[3], *variance, *normal[3], *depth;
  int line, dy;     // which row of the image, and of the kernel
  float kernel[5];  // h of its taps

  TapRow() = default;
  TapRow(const AtrousPass& pass, int y, int place)
      : color{pass.color[0].row(y), pass.color[1].row(y), pass.color[2].row(y)},
        variance(pass.variance.row(y)),
        normal{pass.guides.surface.normal[0].row(y), pass.guides.surface.normal[1].row(y),
               pass.guides.surface.normal[2].row(y)},
        depth(pass.guides.surface.depth.row(y)),
        line(y),
        dy(place) {
    const int radius = pass.options.radius;
    for (int j = -radius; j <= radius; ++j) kernel[j + radius] = Weight(pass, j, place);
  }
};

// N . ray at column 0 of a row.
HWY_INLINE VF AlongRow(const TapRow& row, const Center& at) {
  return hn::MulAdd(at.plane_y, hn::Set(F(), static_cast<float>(row.line)), at.plane_c);
}

// The weight of the taps that `load` fetches, at column `x`, but for the kernel.
template <bool kLight, typename Load>
HWY_INLINE VF TapWeight(const TapRow& row, VF x, VF along_row, Load load, const Center& at) {
  const F d;
  const VF along = hn::MulAdd(at.plane_x, x, along_row);
  const VF plane = hn::Abs(hn::MulSub(load(row.depth), along, at.plane));
  VF decay = hn::Set(d, 1.0f);
  if constexpr (kLight) {
    const VF tap = Luminance(load(row.color[0]), load(row.color[1]), load(row.color[2]));
    const VF light = hn::Abs(hn::Sub(tap, at.luminance));
    decay = hn::NegMulAdd(light, at.luminance_scale, decay);
  }
  decay = hn::NegMulAdd(plane, at.plane_scale, decay);
  VF cosine = hn::Mul(at.normal[0], load(row.normal[0]));
  cosine = hn::MulAdd(at.normal[1], load(row.normal[1]), cosine);
  cosine = hn::MulAdd(at.normal[2], load(row.normal[2]), cosine);
  // Sky has infinite depth and so NaN or -inf here: the comparison fails. So do normals that are no
  // unit vectors, whose 64th power would be Inf.
  const auto valid =
      hn::And(hn::Gt(decay, hn::Zero(d)),
              hn::And(hn::Gt(cosine, hn::Zero(d)), hn::Le(cosine, hn::Set(d, kLargestCosine))));
  // (1 - x/8)^8 and (N . N)^64 share their squarings.
  for (int s = 0; s < 3; ++s) cosine = hn::Mul(cosine, cosine);
  VF w = hn::Mul(cosine, decay);
  for (int s = 0; s < 3; ++s) w = hn::Mul(w, w);
  return hn::IfThenElseZero(valid, w);
}

// Adds those taps to the center with weight w.
template <typename Load>
HWY_INLINE void AddTap(const TapRow& row, VF w, Load load, Center& at) {
  for (int c = 0; c < 3; ++c) at.sum[c] = hn::MulAdd(w, load(row.color[c]), at.sum[c]);
  at.weight = hn::Add(at.weight, w);
  at.variance = hn::MulAdd(hn::Mul(w, w), load(row.variance), at.variance);
}

// A tap row for the pixels x .. x + lanes, of which some taps lie outside the image: kernel 0
// there.
template <int kRadius, bool kLight>
void AddEdgeRow(const AtrousPass& pass, const TapRow& row, int x, Center& at) {
  const F d;
  const VF along = AlongRow(row, at);
  const int lanes = static_cast<int>(hn::Lanes(d)), last = pass.variance.width() - 1;
  alignas(64) float values[64];
  for (int j = -kRadius; j <= kRadius; ++j) {
    if (j == 0 && row.dy == 0) continue;
    const int first = x + j * pass.step;
    const auto load = [&](const float* source) {
      for (int l = 0; l < lanes; ++l) values[l] = source[std::clamp(first + l, 0, last)];
      return hn::Load(d, values);
    };
    const VF column = hn::Iota(d, static_cast<float>(first));
    const auto inside =
        hn::And(hn::Ge(column, hn::Zero(d)), hn::Le(column, hn::Set(d, static_cast<float>(last))));
    const VF kernel = hn::IfThenElseZero(inside, hn::Set(d, row.kernel[j + kRadius]));
    AddTap(row, hn::Mul(kernel, TapWeight<kLight>(row, column, along, load, at)), load, at);
  }
}

// All weights first: what weights and sums need does not fit 16 registers at once.
template <int kRadius, bool kLight>
HWY_INLINE void AddRow(const TapRow& row, int step, int x, Center& at) {
  const F d;
  const VF along = AlongRow(row, at);
  const auto loader = [&](int j) {
    return [first = x + j * step](const float* source) { return hn::LoadU(F(), source + first); };
  };
  VF weight[2 * kRadius + 1];
  for (int j = -kRadius; j <= kRadius; ++j) {
    if (j == 0 && row.dy == 0) continue;
    const VF column = hn::Iota(d, static_cast<float>(x + j * step));
    weight[j + kRadius] = hn::Mul(hn::Set(d, row.kernel[j + kRadius]),
                                  TapWeight<kLight>(row, column, along, loader(j), at));
  }
  for (int j = -kRadius; j <= kRadius; ++j) {
    if (j == 0 && row.dy == 0) continue;
    AddTap(row, weight[j + kRadius], loader(j), at);
  }
}

// Writes the lanes whose pixels show a surface; the others keep their value. Lanes beyond the row
// write its padding.
HWY_INLINE void StoreCenter(const AtrousPass& pass, const Center& at, int x, int y) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const auto id = hn::LoadU(du, pass.guides.surface.id.row(y) + x);
  const auto surface = hn::RebindMask(d, hn::Ne(id, hn::Zero(du)));
  const VF scale = hn::Div(hn::Set(d, 1.0f), at.weight);
  const auto store = [&](VF value, const Plane<float>& from, Plane<float>& to) {
    hn::StoreU(hn::IfThenElse(surface, value, hn::LoadU(d, from.row(y) + x)), d, to.row(y) + x);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    store(hn::Mul(at.sum[c], scale), pass.color[c], pass.out_color[c]);
  }
  store(hn::Mul(at.variance, hn::Mul(scale, scale)), pass.variance, pass.out_variance);
}

// The rows of taps inside the image. Returns how many.
template <int kRadius>
int FindRows(const AtrousPass& pass, int y, TapRow (&rows)[2 * kRadius + 1]) {
  int count = 0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    const int ty = y + dy * pass.step;
    if (ty >= 0 && ty < pass.variance.height()) rows[count++] = TapRow(pass, ty, dy);
  }
  return count;
}

template <int kRadius, bool kLight>
void FilterTile(const AtrousPass& pass, const Tile& tile) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), reach = kRadius * pass.step;
  const Extent extent = pass.variance.extent();
  alignas(64) Line smooth_variance = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (kLight) SmoothVariance(pass.variance, tile.x0, tile.x1 - tile.x0, y, smooth_variance);
    TapRow rows[2 * kRadius + 1];
    const int used = FindRows<kRadius>(pass, y, rows);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Center at = LoadCenter<kLight>(pass, x, y, hn::Load(d, smooth_variance + (x - tile.x0)));
      const bool inside = x - reach >= 0 && x + lanes + reach <= extent.width;
      for (int r = 0; r < used; ++r) {
        if (inside) {
          AddRow<kRadius, kLight>(rows[r], pass.step, x, at);
        } else {
          AddEdgeRow<kRadius, kLight>(pass, rows[r], x, at);
        }
      }
      StoreCenter(pass, at, x, y);
    }
  }
}

void AtrousTile(const AtrousPass& pass, const Tile& tile) {
  const bool light = pass.options.looks_at_light();
  if (pass.options.radius == 1) {
    light ? FilterTile<1, true>(pass, tile) : FilterTile<1, false>(pass, tile);
  } else {
    light ? FilterTile<2, true>(pass, tile) : FilterTile<2, false>(pass, tile);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(AtrousTile);

void atrous_tile(const AtrousPass& pass, const Tile& tile) {
  EL_DCHECK(tile.x1 - tile.x0 <= kAtrousWidth);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(AtrousTile)(pass, tile);
}

}  // namespace eigenlight
#endif
