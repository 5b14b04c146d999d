#include <algorithm>
#include <cmath>

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

constexpr float kSpline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

VF Luminance(VF r, VF g, VF b) {
  const F d;
  return hn::MulAdd(hn::Set(d, 0.2126f), r,
                    hn::MulAdd(hn::Set(d, 0.7152f), g, hn::Mul(hn::Set(d, 0.0722f), b)));
}

// What one row of output pixels compares its neighbors with, and what it has gathered of them.
struct Row {
  alignas(64) Line normal[3];
  alignas(64) Line plane_x, plane_y, plane_c;  // N . ray(x, y) = plane_x x + plane_y y + plane_c
  alignas(64) Line plane;                      // N . (X - eye)
  alignas(64) Line plane_scale;                // 1 / (8 plane_distance depth)
  alignas(64) Line luminance;
  alignas(64) Line luminance_scale;  // 1 / (8 (sigmas sigma + 1e-4 luminance))
  alignas(64) Line sum[3], weight, variance;
};

// Variance of luminance around the pixels [x0, x0 + count) of row y: 3 x 3 binomial, edges
// repeated.
void SmoothVariance(const Plane<float>& variance, int x0, int count, int y, float* out) {
  const float* upper = variance.row(std::max(y - 1, 0));
  const float* middle = variance.row(y);
  const float* lower = variance.row(std::min(y + 1, variance.height() - 1));
  float column[kAtrousWidth + 2];
  for (int i = 0; i < count + 2; ++i) {
    const int x = std::clamp(x0 + i - 1, 0, variance.width() - 1);
    column[i] = upper[x] + 2.0f * middle[x] + lower[x];
  }
  for (int i = 0; i < count; ++i) {
    out[i] = (column[i] + 2.0f * column[i + 1] + column[i + 2]) * (1.0f / 16.0f);
  }
}

void LoadCenters(const AtrousPass& pass, int x0, int count, int y, Row& row) {
  const F d;
  const Camera& camera = pass.guides.camera;
  const glm::mat3 to_view = camera.world_to_view;
  alignas(64) Line smooth_variance = {};
  SmoothVariance(pass.variance, x0, count, y, smooth_variance);
  const VF inverse_focal = hn::Set(d, 1.0f / camera.focal);
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
    const auto load = [&](const Plane<float>& plane) {
      return hn::LoadU(d, plane.row(y) + x0 + i);
    };
    const VF n[3] = {load(pass.guides.surface.normal[0]), load(pass.guides.surface.normal[1]),
                     load(pass.guides.surface.normal[2])};
    const auto view_normal = [&](int r) {
      VF v = hn::Mul(hn::Set(d, to_view[0][r]), n[0]);
      v = hn::MulAdd(hn::Set(d, to_view[1][r]), n[1], v);
      return hn::MulAdd(hn::Set(d, to_view[2][r]), n[2], v);
    };
    const VF px = hn::Mul(view_normal(0), inverse_focal);
    const VF py = hn::Mul(view_normal(1), inverse_focal);
    const VF pc =
        hn::NegMulAdd(px, hn::Set(d, camera.center.x - 0.5f),
                      hn::NegMulAdd(py, hn::Set(d, camera.center.y - 0.5f), view_normal(2)));
    const VF depth = load(pass.guides.surface.depth);
    const VF x = hn::Iota(d, static_cast<float>(x0 + i));
    const VF along = hn::MulAdd(px, x, hn::MulAdd(py, hn::Set(d, static_cast<float>(y)), pc));
    for (int c = 0; c < 3; ++c) hn::Store(n[c], d, row.normal[c] + i);
    hn::Store(px, d, row.plane_x + i);
    hn::Store(py, d, row.plane_y + i);
    hn::Store(pc, d, row.plane_c + i);
    hn::Store(hn::Mul(depth, along), d, row.plane + i);
    hn::Store(hn::Div(hn::Set(d, 0.125f), hn::Mul(hn::Set(d, pass.options.plane_distance), depth)),
              d, row.plane_scale + i);

    const VF color[3] = {load(pass.color[0]), load(pass.color[1]), load(pass.color[2])};
    const VF luminance = Luminance(color[0], color[1], color[2]);
    const VF sigma = hn::Sqrt(hn::Load(d, smooth_variance + i));
    const VF tolerance = hn::MulAdd(hn::Set(d, pass.options.luminance_sigmas), sigma,
                                    hn::Mul(hn::Set(d, 1e-4f), hn::Abs(luminance)));
    // 1e-20 only keeps black on black from dividing by zero.
    hn::Store(luminance, d, row.luminance + i);
    hn::Store(hn::Div(hn::Set(d, 0.125f), hn::Add(tolerance, hn::Set(d, 1e-20f))), d,
              row.luminance_scale + i);

    // The center tap always counts, whatever its normal.
    const VF own = hn::Set(d, kSpline[2] * kSpline[2]);
    for (int c = 0; c < 3; ++c) hn::Store(hn::Mul(own, color[c]), d, row.sum[c] + i);
    hn::Store(own, d, row.weight + i);
    hn::Store(hn::Mul(hn::Mul(own, own), load(pass.variance)), d, row.variance + i);
  }
}

// Adds the tap (dx, dy) to all pixels of the row at once.
void AddTap(const AtrousPass& pass, const Tile& segment, int dx, int dy, Row& row) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Extent extent = pass.variance.extent();
  const int x0 = segment.x0, ty = segment.y0 + dy;
  // Lanes that would reach outside the image left or right are masked below; whole vectors that
  // start outside are left out here.
  const int count = segment.x1 - x0;
  const float kernel = kSpline[dx / pass.step + 2] * kSpline[dy / pass.step + 2];
  const VF one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto& surface = pass.guides.surface;
  const float* const rows[8] = {pass.color[0].row(ty),     pass.color[1].row(ty),
                                pass.color[2].row(ty),     pass.variance.row(ty),
                                surface.normal[0].row(ty), surface.normal[1].row(ty),
                                surface.normal[2].row(ty), surface.depth.row(ty)};
  for (int i = 0; i < count; i += lanes) {
    const int tx = x0 + i + dx;
    if (tx + lanes <= 0 || tx >= extent.width) continue;
    const bool whole = tx >= 0 && tx + lanes <= extent.width;
    alignas(64) float edge[64];
    const auto load = [&](const float* source) {
      if (whole) return hn::LoadU(d, source + tx);
      for (int l = 0; l < lanes; ++l) edge[l] = source[std::clamp(tx + l, 0, extent.width - 1)];
      return hn::Load(d, edge);
    };
    const VF depth = load(rows[7]);
    const VF qx = hn::Iota(d, static_cast<float>(tx));
    const VF along =
        hn::MulAdd(hn::Load(d, row.plane_x + i), qx,
                   hn::MulAdd(hn::Load(d, row.plane_y + i), hn::Set(d, static_cast<float>(ty)),
                              hn::Load(d, row.plane_c + i)));
    const VF plane = hn::Abs(hn::MulSub(depth, along, hn::Load(d, row.plane + i)));
    const VF r = load(rows[0]), g = load(rows[1]), b = load(rows[2]);
    const VF light = hn::Abs(hn::Sub(Luminance(r, g, b), hn::Load(d, row.luminance + i)));
    const VF exponent = hn::MulAdd(plane, hn::Load(d, row.plane_scale + i),
                                   hn::Mul(light, hn::Load(d, row.luminance_scale + i)));
    // (1 - x/8)^8 and (N . N)^64 share their squarings; NaN (sky: inf depth) ends as 0 in the mask.
    const VF decay = hn::Sub(one, exponent);
    VF cosine = hn::Mul(hn::Load(d, row.normal[0] + i), load(rows[4]));
    cosine = hn::MulAdd(hn::Load(d, row.normal[1] + i), load(rows[5]), cosine);
    cosine = hn::MulAdd(hn::Load(d, row.normal[2] + i), load(rows[6]), cosine);
    auto valid = hn::And(hn::Gt(decay, zero), hn::Gt(cosine, zero));
    if (!whole) {
      valid = hn::And(valid, hn::And(hn::Ge(qx, zero),
                                     hn::Lt(qx, hn::Set(d, static_cast<float>(extent.width)))));
    }
    for (int s = 0; s < 3; ++s) cosine = hn::Mul(cosine, cosine);
    VF w = hn::Mul(cosine, decay);
    for (int s = 0; s < 3; ++s) w = hn::Mul(w, w);
    w = hn::IfThenElseZero(valid, hn::Mul(w, hn::Set(d, kernel)));

    const auto add = [&](Line& line, VF weight, VF value) {
      hn::Store(hn::MulAdd(weight, value, hn::Load(d, line + i)), d, line + i);
    };
    add(row.sum[0], w, r);
    add(row.sum[1], w, g);
    add(row.sum[2], w, b);
    add(row.weight, w, one);
    add(row.variance, hn::Mul(w, w), load(rows[3]));
  }
}

void StoreRow(const AtrousPass& pass, const Tile& segment, const Row& row) {
  for (int x = segment.x0; x < segment.x1; ++x) {
    const int i = x - segment.x0, y = segment.y0;
    const bool surface = pass.guides.surface.id(x, y) != 0;
    const float scale = surface ? 1.0f / row.weight[i] : 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      pass.out_color[c](x, y) = surface ? row.sum[c][i] * scale : pass.color[c](x, y);
    }
    pass.out_variance(x, y) = surface ? row.variance[i] * scale * scale : pass.variance(x, y);
  }
}

void AtrousTile(const AtrousPass& pass, const Tile& tile) {
  const int height = pass.variance.height();
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    LoadCenters(pass, tile.x0, tile.x1 - tile.x0, y, row);
    for (int dy = -2 * pass.step; dy <= 2 * pass.step; dy += pass.step) {
      if (y + dy < 0 || y + dy >= height) continue;
      for (int dx = -2 * pass.step; dx <= 2 * pass.step; dx += pass.step) {
        if (dx != 0 || dy != 0) AddTap(pass, segment, dx, dy, row);
      }
    }
    StoreRow(pass, segment, row);
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
  HWY_DYNAMIC_DISPATCH(AtrousTile)(pass, tile);
}

}  // namespace eigenlight
#endif
