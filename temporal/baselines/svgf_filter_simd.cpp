#include <algorithm>

#include "temporal/baselines/svgf_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/baselines/svgf_filter_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/math-inl.h"
#include "frame/surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

constexpr int kWidth = 64;  // widest tile
constexpr float kSpline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

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

// The surfaces and the light of a vector of output pixels, which weigh their taps.
struct Center {
  VF3 normal;
  VF depth, slope_x, slope_y, depth_epsilon;
  VF luminance, luminance_scale;
};

// Weighted sums over the taps.
struct Sums {
  VF3 color;
  VF weight, variance;
};

void LoadGeometry(const SvgfPass& pass, int x, int y, Center& at) {
  const GBuffer& surface = pass.guides.surface;
  const Camera& camera = pass.guides.camera;
  at.normal = Load(surface.normal, x, y);
  at.depth = Load(surface.depth, x, y);
  VF3 normal;  // in view space
  for (int r = 0; r < 3; ++r) normal[r] = DotInOrder(ViewAxis(camera, r), at.normal);
  // z = plane / (N . ray), so dz/dx = -z N_x / (focal N . ray); its sign never matters.
  const Rays rays(camera);
  const float ray_y = (static_cast<float>(y) + 0.5f - camera.center.y) / camera.focal;
  const VF ray_x = rays.X(Iota(static_cast<float>(x) + 0.5f));
  const VF along = Abs(MulAdd(normal[0], ray_x, MulAdd(normal[1], Set(ray_y), normal[2])));
  // A plane seen from its edge has any slope: 1e-3 bounds it.
  const VF scale = Div(Mul(at.depth, rays.inverse_focal), Max(along, Set(1e-3f)));
  const VF sigma = Set(pass.weights.depth_slopes);
  at.slope_x = Mul(Mul(normal[0], scale), sigma);
  at.slope_y = Mul(Mul(normal[1], scale), sigma);
  // An invalid depth must not make the weight grow.
  at.depth_epsilon = Mul(Max(at.depth, Zero()), Set(1e-3f));
}

void LoadLight(const SvgfPass& pass, const VF3& color, VF smooth_variance, Center& at) {
  at.luminance = Luminance(color);
  const VF tolerance = MulAdd(Set(pass.weights.luminance_sigmas), Sqrt(smooth_variance),
                              Mul(Set(1e-4f), Abs(at.luminance)));
  // 1e-20 only keeps black on black from a division by zero.
  at.luminance_scale = Div(Set(1), Add(tolerance, Set(1e-20f)));
}

// The center tap always counts, whatever its normal.
Sums StartSums(const VF3& color, VF variance) {
  const VF own = Set(kSpline[2] * kSpline[2]);
  return {{{Mul(own, color[0]), Mul(own, color[1]), Mul(own, color[2])}},
          own,
          Mul(Mul(own, own), variance)};
}

// Adds the taps that `load` fetches, `offset` pixels away, to the sums.
template <typename LoadTap>
HWY_INLINE void AddTap(const SvgfPass& pass, const TapRow& row, glm::vec2 offset, VF kernel,
                       LoadTap load, const Center& at, Sums& sums) {
  const VF slope = Abs(MulAdd(at.slope_x, Set(offset.x), Mul(at.slope_y, Set(offset.y))));
  const VF apart = Div(Abs(Sub(load(row.depth), at.depth)), Add(slope, at.depth_epsilon));
  const VF3 color{{load(row.color[0]), load(row.color[1]), load(row.color[2])}};
  const VF light = Abs(Sub(Luminance(color), at.luminance));
  VF cosine =
      DotInOrder(at.normal, {{load(row.normal[0]), load(row.normal[1]), load(row.normal[2])}});
  // Normals that are not unit vectors would have powers without bound.
  const MF unit = And(Gt(cosine, Zero()), Le(cosine, Set(kLargestCosine)));
  const MF valid = And(Gt(load(row.known), Zero()), unit);
  for (int s = 0; s < pass.weights.normal_squarings; ++s) cosine = Mul(cosine, cosine);
  const VF decay = Exp(F(), hn::Neg(MulAdd(light, at.luminance_scale, apart)));
  // Where nothing is seen depths are infinite and the product is NaN.
  const VF w = IfThenElseZero(valid, Mul(Mul(cosine, decay), kernel));
  for (int c = 0; c < 3; ++c) sums.color[c] = MulAdd(w, color[c], sums.color[c]);
  sums.weight = Add(sums.weight, w);
  sums.variance = MulAdd(Mul(w, w), load(row.variance), sums.variance);
}

// Adds a row of taps of the pixels from x on. Taps beside the image have kernel 0.
void AddRow(const SvgfPass& pass, const TapRow& row, int x, int dy, const Center& at, Sums& sums) {
  const int lanes = LaneCount(), last = pass.known.width() - 1;
  const float down = static_cast<float>(dy * pass.step);
  alignas(HWY_MAX_BYTES) float values[HWY_MAX_BYTES / sizeof(float)];
  for (int dx = -2; dx <= 2; ++dx) {
    if (dx == 0 && dy == 0) continue;
    const int first = x + dx * pass.step;
    const glm::vec2 offset(static_cast<float>(dx * pass.step), down);
    const VF kernel = Set(kSpline[dx + 2] * kSpline[dy + 2]);
    if (first >= 0 && first + lanes <= pass.known.width()) {
      const auto load = [&](const float* source) { return LoadU(F(), source + first); };
      AddTap(pass, row, offset, kernel, load, at, sums);
      continue;
    }
    const auto load = [&](const float* source) {
      for (int l = 0; l < lanes; ++l) values[l] = source[std::clamp(first + l, 0, last)];
      return Load(F(), values);
    };
    const VF column = Iota(first);
    const MF inside = And(Ge(column, Zero()), Le(column, Set(last)));
    AddTap(pass, row, offset, IfThenElseZero(inside, kernel), load, at, sums);
  }
}

void FilterVector(const SvgfPass& pass, const SvgfImage& in, int x, int y, VF smooth_variance,
                  SvgfImage& out) {
  const VF3 color = Load(in.color, x, y);
  Center at;
  LoadGeometry(pass, x, y, at);
  LoadLight(pass, color, smooth_variance, at);
  Sums sums = StartSums(color, Load(in.variance, x, y));
  for (int dy = -2; dy <= 2; ++dy) {
    const int line = y + dy * pass.step;
    if (line < 0 || line >= pass.known.height()) continue;
    AddRow(pass, TapRow(pass, in, line), x, dy, at, sums);
  }
  // Lanes beyond the row write its padding.
  const MF known = Gt(Load(pass.known, x, y), Zero());
  const VF scale = Div(Set(1), sums.weight);
  for (int c = 0; c < 3; ++c) {
    Store(IfThenElseZero(known, Mul(sums.color[c], scale)), out.color[c], x, y);
  }
  Store(IfThenElseZero(known, Mul(sums.variance, Mul(scale, scale))), out.variance, x, y);
}

void PassTile(const SvgfPass& pass, const SvgfImage& in, const Rect& tile, SvgfImage& out) {
  alignas(HWY_MAX_BYTES) float smooth_variance[kWidth + HWY_MAX_BYTES / sizeof(float)] = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    SmoothVariance(in.variance, tile.x0, tile.x1 - tile.x0, y, smooth_variance);
    for (int x = tile.x0; x < tile.x1; x += LaneCount()) {
      FilterVector(pass, in, x, y, LoadU(F(), smooth_variance + (x - tile.x0)), out);
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
