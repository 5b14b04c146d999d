#include <algorithm>

#include "spatial/rivals/cross_bilateral_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/cross_bilateral_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/rivals/tap_planes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Exponents are -1/2 x^2 / sigma^2: these are -1/2 / sigma^2.
struct Scales {
  float space, normal, albedo, plane;
};

float Scale(float sigma) { return -0.5f / (sigma * sigma); }

// A vector of output pixels.
struct Center {
  Vec3<VF16> normal, albedo;
  VF16 plane;        // N . X
  VF16 plane_scale;  // of (N . (X_q - X_p))^2: by depth
};

// The planes of one row of taps.
struct TapRow {
  TapRows normal, position, albedo, color;
  const float* weight;

  TapRow(const TapPlanes& planes, int y)
      : normal(planes, planes.normal, y),
        position(planes, planes.position, y),
        albedo(planes, planes.albedo, y),
        color(planes, planes.light.color, y),
        weight(planes.row(planes.light.weight, y)) {}
};

Center LoadCenter(const TapPlanes& planes, int x, int y, float plane_scale) {
  const F16 d;
  const TapRow row(planes, y);
  Center at{row.normal.Load(x), row.albedo.Load(x), {}, {}};
  at.plane = Dot(at.normal, row.position.Load(x));
  const VF16 depth = LoadU(d, planes.row(planes.depth, y) + x);
  at.plane_scale = Div(Set(d, plane_scale), Mul(depth, depth));
  return at;
}

// `exponent`: that of the distance in the image.
HWY_INLINE void AddTap(const Center& at, const Scales& scales, const TapRow& row, int x,
                       float exponent, TapSums& sums) {
  const F16 d;
  const VF16 plane = Sub(Dot(at.normal, row.position.Load(x)), at.plane);
  VF16 e = MulAdd(Mul(plane, plane), at.plane_scale, Set(d, exponent));
  e = MulAdd(SquaredDistance(at.normal, row.normal.Load(x)), Set(d, scales.normal), e);
  e = MulAdd(SquaredDistance(at.albedo, row.albedo.Load(x)), Set(d, scales.albedo), e);
  sums.Add(Mul(Exp(d, e), LoadU(d, row.weight + x)), row.color.Load(x));
}

void BilateralTile(const TapPlanes& planes, const CrossBilateralOptions& options, const Rect& tile,
                   Planes<3>& out) {
  const F16 d;
  const int r = options.radius;
  const Scales scales{Scale(0.5f * static_cast<float>(r)), Scale(options.sigma_normal),
                      Scale(options.sigma_albedo), Scale(options.sigma_plane)};
  const auto filter = [&](int x, int y) {
    const Center at = LoadCenter(planes, x, y, scales.plane);
    TapSums sums;
    for (int ty = std::max(y - r, 0); ty <= std::min(y + r, planes.extent().height - 1); ++ty) {
      const TapRow row(planes, ty);
      for (int dx = -r; dx <= r; ++dx) {
        const int squared = dx * dx + (ty - y) * (ty - y);
        AddTap(at, scales, row, x + dx, scales.space * static_cast<float>(squared), sums);
      }
    }
    const MF16 some = sums.HasMean(planes, x, y);
    for (int c = 0; c < 3; ++c) {
      Store(IfThenElseZero(some, sums.Mean(c)), out[c], x, y, d);
    }
  };
  ForEachVector(tile, filter, d);
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(BilateralTile);

void cross_bilateral_tile(const TapPlanes& planes, const CrossBilateralOptions& options,
                          const Rect& tile, Planes<3>& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(BilateralTile)(planes, options, tile, out);
}

}  // namespace eigenlight
#endif
