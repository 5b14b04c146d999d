#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/rivals/cross_bilateral_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/cross_bilateral_simd.cpp"
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

// Exponents are -1/2 x^2 / sigma^2: these are -1/2 / sigma^2.
struct Scales {
  float space, normal, albedo, plane;
};

float Scale(float sigma) { return -0.5f / (sigma * sigma); }

struct Center {
  VF normal[3], albedo[3];
  VF plane;        // N . X
  VF plane_scale;  // of (N . (X_q - X_p))^2: by depth
};

// The planes of one row of taps, at column 0.
struct TapRow {
  const float *normal[3], *position[3], *albedo[3], *color[3], *weight;

  TapRow(const TapPlanes& planes, int y) : weight(planes.row(planes.light.weight, y)) {
    for (std::size_t c = 0; c < 3; ++c) {
      normal[c] = planes.row(planes.normal[c], y);
      position[c] = planes.row(planes.position[c], y);
      albedo[c] = planes.row(planes.albedo[c], y);
      color[c] = planes.row(planes.light.color[c], y);
    }
  }
};

struct Sums {
  VF color[3], weight;
};

VF Dot(const VF (&a)[3], VF x, VF y, VF z) {
  return hn::MulAdd(a[0], x, hn::MulAdd(a[1], y, hn::Mul(a[2], z)));
}

Center LoadCenter(const TapPlanes& planes, int x, int y, float plane_scale) {
  const F d;
  const TapRow row(planes, y);
  Center at;
  VF position[3];
  for (int c = 0; c < 3; ++c) {
    at.normal[c] = hn::LoadU(d, row.normal[c] + x);
    at.albedo[c] = hn::LoadU(d, row.albedo[c] + x);
    position[c] = hn::LoadU(d, row.position[c] + x);
  }
  at.plane = Dot(at.normal, position[0], position[1], position[2]);
  const VF depth = hn::LoadU(d, planes.row(planes.depth, y) + x);
  at.plane_scale = hn::Div(hn::Set(d, plane_scale), hn::Mul(depth, depth));
  return at;
}

HWY_INLINE void AddTap(const Center& at, const Scales& scales, const TapRow& row, int x,
                       VF exponent, Sums& sums) {
  const F d;
  const auto load = [&](const float* plane) { return hn::LoadU(d, plane + x); };
  const auto square = [&](const VF(&a)[3], const float* const(&b)[3]) {
    const VF u = hn::Sub(a[0], load(b[0])), v = hn::Sub(a[1], load(b[1]));
    const VF w = hn::Sub(a[2], load(b[2]));
    return hn::MulAdd(u, u, hn::MulAdd(v, v, hn::Mul(w, w)));
  };
  const VF plane =
      hn::Sub(Dot(at.normal, load(row.position[0]), load(row.position[1]), load(row.position[2])),
              at.plane);
  exponent = hn::MulAdd(hn::Mul(plane, plane), at.plane_scale, exponent);
  exponent = hn::MulAdd(square(at.normal, row.normal), hn::Set(d, scales.normal), exponent);
  exponent = hn::MulAdd(square(at.albedo, row.albedo), hn::Set(d, scales.albedo), exponent);
  const VF w = hn::Mul(hn::Exp(d, exponent), load(row.weight));
  for (int c = 0; c < 3; ++c) {
    sums.color[c] = hn::MulAdd(w, load(row.color[c]), sums.color[c]);
  }
  sums.weight = hn::Add(sums.weight, w);
}

// Stores the means where the pixel is a surface and something has a weight.
void StoreMeans(const TapPlanes& planes, const Sums& sums, int x, int y, Planes<3>& out) {
  const F d;
  const VF surface = hn::LoadU(d, planes.row(planes.surface, y) + x);
  const auto some = hn::And(hn::Gt(surface, hn::Zero(d)), hn::Gt(sums.weight, hn::Zero(d)));
  for (std::size_t c = 0; c < 3; ++c) {
    const VF mean = hn::Div(sums.color[c], sums.weight);
    hn::StoreU(hn::IfThenElseZero(some, mean), d, out[c].row(y) + x);
  }
}

void BilateralTile(const TapPlanes& planes, const CrossBilateralOptions& options, const Rect& tile,
                   Planes<3>& out) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), r = options.radius;
  const Scales scales{Scale(0.5f * static_cast<float>(r)), Scale(options.sigma_normal),
                      Scale(options.sigma_albedo), Scale(options.sigma_plane)};
  const int height = planes.extent().height;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      const Center at = LoadCenter(planes, x, y, scales.plane);
      Sums sums{{hn::Zero(d), hn::Zero(d), hn::Zero(d)}, hn::Zero(d)};
      for (int ty = std::max(y - r, 0); ty <= std::min(y + r, height - 1); ++ty) {
        const TapRow row(planes, ty);
        for (int dx = -r; dx <= r; ++dx) {
          const int squared = dx * dx + (ty - y) * (ty - y);
          AddTap(at, scales, row, x + dx, hn::Set(d, scales.space * static_cast<float>(squared)),
                 sums);
        }
      }
      StoreMeans(planes, sums, x, y, out);
    }
  }
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
