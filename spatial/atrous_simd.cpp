#include <algorithm>
#include <span>

#include "spatial/atrous_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/atrous_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/surface-inl.h"
#include "spatial/atrous_taps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Which light the weight of a tap depends on.
enum class LightOf { kNone, kOwn, kOwnAndEarlier };

// What the weight of a tap depends on.
template <bool kGeometryWeighs, LightOf kLightOf>
struct Weighing {
  static constexpr bool kGeometry = kGeometryWeighs, kLight = kLightOf != LightOf::kNone;
  static constexpr bool kEarlier = kLightOf == LightOf::kOwnAndEarlier;
};

struct Geometry {
  TangentPlanes planes;
  VF scale;  // 1 / (8 plane_distance depth)
};

HWY_INLINE Geometry LoadGeometry(const AtrousPass& pass, int x, int y) {
  const GBuffer& surface = pass.guides.surface;
  const VF depth = Load(surface.depth, x, y);
  // An invalid depth must not make the weight grow: it leaves no valid tap.
  const VF tolerance = Max(Mul(Set(pass.options.plane_distance), depth), Zero());
  return {TangentPlanes(pass.guides.camera, Load(surface.normal, x, y), depth, x, y),
          Div(Set(0.125f), tolerance)};
}

// The light of the output pixels, and 1 / (8 tolerance) of its difference to that of a tap.
struct Light {
  VF luminance, scale;
  VF earlier, earlier_scale;
};

// 1 / (8 (sigmas sigma + share |luminance|))
HWY_INLINE VF LightScale(float sigmas, VF sigma, float share, VF luminance) {
  const VF tolerance = MulAdd(Set(sigmas), sigma, Mul(Set(share), Abs(luminance)));
  // 1e-20 only keeps black on black from a division by zero.
  return Div(Set(0.125f), Add(tolerance, Set(1e-20f)));
}

// NaN stands for an unknown value, which does not count.
HWY_INLINE VF KnownOrZero(VF v) { return IfThenZeroElse(IsNaN(v), v); }

template <typename By>
HWY_INLINE Light LoadLight(const AtrousPass& pass, int x, int y, VF smooth_variance) {
  const AtrousOptions& options = pass.options;
  const VF sigma = Sqrt(smooth_variance);
  Light light;
  light.luminance = Luminance(Load(pass.color, x, y));
  light.scale = LightScale(options.luminance_sigmas, sigma, 1e-4f, light.luminance);
  if constexpr (By::kEarlier) {
    light.earlier = Load(*pass.earlier, x, y);
    light.earlier_scale = KnownOrZero(
        LightScale(options.earlier_sigmas, sigma, options.earlier_share, light.earlier));
  }
  return light;
}

// Weighted sums over the taps of the output pixels.
struct Sums {
  VF3 color;
  VF weight, variance;
};

// The center tap always counts, whatever its normal.
HWY_INLINE Sums LoadCenter(const AtrousPass& pass, int x, int y) {
  const VF own = Set(kAtrousKernel[1] * kAtrousKernel[1]);
  Sums sums;
  for (int c = 0; c < 3; ++c) sums.color[c] = Mul(own, Load(pass.color[c], x, y));
  sums.weight = own;
  sums.variance = Mul(Mul(own, own), Load(pass.variance, x, y));
  return sums;
}

// The eighth root of the weight of geometry: (N_p . N_q)^8 (1 - distance off the plane / 8).
template <typename Taps>
HWY_INLINE VF GeometryRoot(const AtrousTapRow& row, const Taps& taps, int j, VF along_row,
                           const Geometry& at) {
  const VF along = MulAdd(at.planes.x, Set(j * taps.step), along_row);
  const VF off = Abs(MulSub(along, taps.Load(row.depth, j), at.planes.distance));
  const VF decay = NegMulAdd(off, at.scale, Set(1));
  VF cosine = DotInOrder(
      at.planes.normal,
      {{taps.Load(row.normal[0], j), taps.Load(row.normal[1], j), taps.Load(row.normal[2], j)}});
  // Sky has infinite depth and so NaN or -inf here: the comparison fails. So do normals that are
  // not unit vectors, whose 64th power would be Inf.
  const MF valid = And(Gt(decay, Zero()), And(Gt(cosine, Zero()), Le(cosine, Set(kLargestCosine))));
  for (int s = 0; s < 3; ++s) cosine = Mul(cosine, cosine);
  return IfThenElseZero(valid, Mul(cosine, decay));
}

// The eighth root of the weight of light.
template <typename By, typename Taps>
HWY_INLINE VF LightRoot(const AtrousTapRow& row, const Taps& taps, int j, const VF3& color,
                        const Light& at) {
  const VF off = Abs(Sub(Luminance(color), at.luminance));
  VF decay = NegMulAdd(off, at.scale, Set(1));
  if constexpr (By::kEarlier) {
    const VF earlier_off = Abs(Sub(taps.Load(row.earlier, j), at.earlier));
    decay = NegMulAdd(KnownOrZero(earlier_off), at.earlier_scale, decay);
  }
  return IfThenElseZero(Gt(decay, Zero()), decay);
}

// Adds taps. `root`: the eighth root of the weight of geometry.
template <typename By, typename Taps>
HWY_INLINE void AddTap(const AtrousTapRow& row, const Taps& taps, int j, VF root, const Light& at,
                       Sums& sums) {
  const VF3 color{
      {taps.Load(row.color[0], j), taps.Load(row.color[1], j), taps.Load(row.color[2], j)}};
  if constexpr (By::kLight) {
    const VF kept = LightRoot<By>(row, taps, j, color, at);
    root = By::kGeometry ? Mul(root, kept) : kept;
  }
  VF w = taps.Kernel(row.kernel[j + 1], j);
  if constexpr (By::kLight || By::kGeometry) {
    for (int s = 0; s < 3; ++s) root = Mul(root, root);
    w = Mul(w, root);
  }
  for (int c = 0; c < 3; ++c) sums.color[c] = MulAdd(w, color[c], sums.color[c]);
  sums.weight = Add(sums.weight, w);
  sums.variance = MulAdd(Mul(w, w), taps.Load(row.variance, j), sums.variance);
}

// Writes the pixels that show a surface; the others keep their value. Lanes beyond the row write
// its padding.
HWY_INLINE void StoreCenter(const AtrousPass& pass, const Sums& sums, int x, int y) {
  const MF surface = HasSurface(pass.guides.surface.id, x, y);
  const VF scale = Div(Set(1), sums.weight);
  const auto store = [&](VF value, const Plane<float>& from, Plane<float>& to) {
    Store(IfThenElse(surface, value, Load(from, x, y)), to, x, y);
  };
  for (int c = 0; c < 3; ++c) store(Mul(sums.color[c], scale), pass.color[c], pass.out_color[c]);
  store(Mul(sums.variance, Mul(scale, scale)), pass.variance, pass.out_variance);
}

// One vector of output pixels. All weights of geometry come first: 16 registers do not hold the
// values that geometry, light and sums need at once.
template <typename By, typename Taps>
HWY_INLINE void FilterVector(const AtrousPass& pass, std::span<const AtrousTapRow> rows,
                             const Taps& taps, int y, VF smooth_variance) {
  VF root[3][3];
  if constexpr (By::kGeometry) {
    const Geometry geometry = LoadGeometry(pass, taps.x, y);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const VF along = geometry.planes.Along(Iota(taps.x), Set(rows[r].line));
      for (int j = -1; j <= 1; ++j) {
        root[r][j + 1] = GeometryRoot(rows[r], taps, j, along, geometry);
      }
    }
  }
  Light light;
  if constexpr (By::kLight) light = LoadLight<By>(pass, taps.x, y, smooth_variance);
  Sums sums = LoadCenter(pass, taps.x, y);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (int j = -1; j <= 1; ++j) {
      if (j == 0 && rows[r].dy == 0) continue;
      AddTap<By>(rows[r], taps, j, root[r][j + 1], light, sums);
    }
  }
  StoreCenter(pass, sums, taps.x, y);
}

// Pixels [x0, x1) of one row.
template <LightOf kLightOf>
void FilterRow(const AtrousPass& pass, int x0, int x1, int y) {
  using Full = Weighing<true, kLightOf>;
  using Planar = Weighing<false, kLightOf>;
  constexpr int kSide = PlanarBlocks::kSide;
  AtrousTapRow found[3];
  std::size_t count = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    const int ty = y + dy * pass.step;
    if (ty >= 0 && ty < pass.variance.height()) found[count++] = AtrousTapRow(pass, ty, dy);
  }
  const std::span<const AtrousTapRow> rows(found, count);
  const int width = pass.variance.width(), margin = (pass.step + kSide - 1) / kSide;
  const std::uint8_t* margins = pass.planar.margins(y / kSide);
  for (int x = x0; x < x1; x += LaneCount()) {
    const VF variance = Full::kLight ? SmoothVariance(pass.variance, x, y) : Zero();
    const int last = std::min(x + LaneCount(), width) - 1;
    if (x - pass.step < 0 || x + LaneCount() + pass.step > width) {
      FilterVector<Full>(pass, rows, EdgeTaps{x, pass.step, width - 1}, y, variance);
    } else if (std::min(margins[x / kSide], margins[last / kSide]) >= margin) {
      FilterVector<Planar>(pass, rows, InnerTaps{x, pass.step}, y, variance);
    } else {
      FilterVector<Full>(pass, rows, InnerTaps{x, pass.step}, y, variance);
    }
  }
}

void AtrousTile(const AtrousPass& pass, const Rect& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (!pass.options.looks_at_light()) {
      FilterRow<LightOf::kNone>(pass, tile.x0, tile.x1, y);
    } else if (pass.earlier == nullptr) {
      FilterRow<LightOf::kOwn>(pass, tile.x0, tile.x1, y);
    } else {
      FilterRow<LightOf::kOwnAndEarlier>(pass, tile.x0, tile.x1, y);
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(AtrousTile);

void atrous_tile(const AtrousPass& pass, const Rect& tile) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(AtrousTile)(pass, tile);
}

}  // namespace eigenlight
#endif
