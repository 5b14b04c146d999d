#include <algorithm>

#include "spatial/atrous_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/atrous_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/strips.h"
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
HWY_INLINE Light LoadLight(const AtrousOptions& options, const AtrousWork& work, int x, int y,
                           VF smooth_variance) {
  const VF sigma = Sqrt(smooth_variance);
  Light light;
  light.luminance = Luminance(Load(*work.color, x, y));
  light.scale = LightScale(options.luminance_sigmas, sigma, 1e-4f, light.luminance);
  if constexpr (By::kEarlier) {
    light.earlier = Load(*work.earlier, x, y);
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
HWY_INLINE Sums LoadCenter(const AtrousWork& work, int x, int y) {
  const VF own = Set(kAtrousKernel[1] * kAtrousKernel[1]);
  Sums sums;
  for (int c = 0; c < 3; ++c) sums.color[c] = Mul(own, Load((*work.color)[c], x, y));
  sums.weight = own;
  sums.variance = Mul(Mul(own, own), Load(*work.variance, x, y));
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
HWY_INLINE VF LightRoot(const AtrousLightRow& row, const Taps& taps, int j, const VF3& color,
                        const Light& at) {
  const VF off = Abs(Sub(Luminance(color), at.luminance));
  VF decay = NegMulAdd(off, at.scale, Set(1));
  if constexpr (By::kEarlier) {
    const VF earlier_off = Abs(Sub(taps.Load(row.earlier, j), at.earlier));
    decay = NegMulAdd(KnownOrZero(earlier_off), at.earlier_scale, decay);
  }
  return IfThenElseZero(Gt(decay, Zero()), decay);
}

// Adds taps. `kernel`: h; `root`: the eighth root of the weight of geometry.
template <typename By, typename Taps>
HWY_INLINE void AddTap(const AtrousLightRow& row, const Taps& taps, int j, float kernel, VF root,
                       const Light& at, Sums& sums) {
  const VF3 color{
      {taps.Load(row.color[0], j), taps.Load(row.color[1], j), taps.Load(row.color[2], j)}};
  if constexpr (By::kLight) {
    const VF kept = LightRoot<By>(row, taps, j, color, at);
    root = By::kGeometry ? Mul(root, kept) : kept;
  }
  VF w = taps.Kernel(kernel, j);
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
HWY_INLINE void StoreCenter(const AtrousWork& work, MF surface, const Sums& sums, int x, int y) {
  const VF scale = Div(Set(1), sums.weight);
  const auto store = [&](VF value, const Plane<float>& from, Plane<float>& to) {
    Store(IfThenElse(surface, value, Load(from, x, y)), to, x, y);
  };
  for (int c = 0; c < 3; ++c) {
    store(Mul(sums.color[c], scale), (*work.color)[c], (*work.out_color)[c]);
  }
  store(Mul(sums.variance, Mul(scale, scale)), *work.variance, *work.out_variance);
}

// Which taps a vector of pixels has.
enum class Kind : std::uint8_t { kPlanar, kInner, kEdge };

// Vectors of a row of pixels, and what all images share of them. It is as long as a strip: images
// that took turns every few vectors would switch between streams of memory too often.
struct Chunk {
  static constexpr int kPixels = kStripWidth;

  int x0, x1, y;
  Kind kind[kPixels];  // of the vector at pixel x0 + i
  // Eighth roots of the weights of geometry, of the taps of one vector after the other; none of
  // vectors whose taps lie in one plane.
  alignas(64) float root[9 * kPixels];
};

// Returns where the roots of the next vector go.
template <typename Taps>
HWY_INLINE float* WeighGeometry(const AtrousPass& pass, const AtrousTapRows& rows, const Taps& taps,
                                int y, float* root) {
  const Geometry geometry = LoadGeometry(pass, taps.x, y);
  for (std::size_t r = 0; r < rows.count; ++r) {
    const VF along = geometry.planes.Along(Iota(taps.x), Set(rows.row[r].line));
    for (int j = -1; j <= 1; ++j, root += LaneCount()) {
      Store(GeometryRoot(rows.row[r], taps, j, along, geometry), F(), root);
    }
  }
  return root;
}

// Finds the kind of each vector, and its weights of geometry, once for all images.
void ShareGeometry(const AtrousPass& pass, const AtrousTapRows& rows, Chunk& chunk) {
  constexpr int kSide = PlanarBlocks::kSide;
  const int width = pass.guides.extent().width, margin = (pass.step + kSide - 1) / kSide;
  const std::uint8_t* margins = pass.planar.margins(chunk.y / kSide);
  float* root = chunk.root;
  for (int x = chunk.x0; x < chunk.x1; x += LaneCount()) {
    const int last = std::min(x + LaneCount(), width) - 1;
    Kind& kind = chunk.kind[x - chunk.x0];
    if (x - pass.step < 0 || x + LaneCount() + pass.step > width) {
      kind = Kind::kEdge;
      root = WeighGeometry(pass, rows, EdgeTaps{x, pass.step, width - 1}, chunk.y, root);
    } else if (std::min(margins[x / kSide], margins[last / kSide]) >= margin) {
      kind = Kind::kPlanar;
    } else {
      kind = Kind::kInner;
      root = WeighGeometry(pass, rows, InnerTaps{x, pass.step}, chunk.y, root);
    }
  }
}

// One vector of pixels of one image; moves `root` on to the next vector that has roots.
template <typename By, typename Taps>
HWY_INLINE void FilterVector(const AtrousPass& pass, const AtrousTapRows& rows, std::size_t image,
                             const Taps& taps, int y, VF smooth_variance, const float*& root) {
  const AtrousWork& work = pass.work[image];
  Light light;
  if constexpr (By::kLight) {
    light = LoadLight<By>(pass.options, work, taps.x, y, smooth_variance);
  }
  Sums sums = LoadCenter(work, taps.x, y);
  for (std::size_t r = 0; r < rows.count; ++r) {
    for (int j = -1; j <= 1; ++j) {
      if (j == 0 && rows.row[r].dy == 0) continue;
      const VF own = By::kGeometry ? Load(F(), root + (j + 1) * LaneCount()) : Zero();
      AddTap<By>(rows.light[image][r], taps, j, rows.row[r].kernel[j + 1], own, light, sums);
    }
    if constexpr (By::kGeometry) root += 3 * LaneCount();
  }
  StoreCenter(work, HasSurface(pass.guides.surface.id, taps.x, y), sums, taps.x, y);
}

template <LightOf kLightOf>
void FilterImage(const AtrousPass& pass, const AtrousTapRows& rows, std::size_t image,
                 const Chunk& chunk) {
  using Full = Weighing<true, kLightOf>;
  using Planar = Weighing<false, kLightOf>;
  const int y = chunk.y;
  const Plane<float>& variance = *pass.work[image].variance;
  const float* root = chunk.root;
  for (int x = chunk.x0; x < chunk.x1; x += LaneCount()) {
    const VF smooth = Full::kLight ? SmoothVariance(variance, x, y) : Zero();
    switch (chunk.kind[x - chunk.x0]) {
      case Kind::kEdge:
        FilterVector<Full>(pass, rows, image, EdgeTaps{x, pass.step, variance.width() - 1}, y,
                           smooth, root);
        break;
      case Kind::kPlanar:
        FilterVector<Planar>(pass, rows, image, InnerTaps{x, pass.step}, y, smooth, root);
        break;
      case Kind::kInner:
        FilterVector<Full>(pass, rows, image, InnerTaps{x, pass.step}, y, smooth, root);
        break;
    }
  }
}

// Pixels [x0, x1) of one row.
template <LightOf kLightOf>
void FilterRow(const AtrousPass& pass, int x0, int x1, int y) {
  const AtrousTapRows rows(pass, y);
  Chunk chunk;
  chunk.y = y;
  for (chunk.x0 = x0; chunk.x0 < x1; chunk.x0 += Chunk::kPixels) {
    chunk.x1 = std::min(chunk.x0 + Chunk::kPixels, x1);
    ShareGeometry(pass, rows, chunk);
    for (std::size_t i = 0; i < pass.work.size(); ++i) {
      FilterImage<kLightOf>(pass, rows, i, chunk);
    }
  }
}

void AtrousTile(const AtrousPass& pass, const Rect& tile) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    if (!pass.options.looks_at_light()) {
      FilterRow<LightOf::kNone>(pass, tile.x0, tile.x1, y);
    } else if (pass.work.front().earlier == nullptr) {
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
