#include <algorithm>
#include <cmath>
#include <span>

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

// Whose light weighs a tap.
enum class LightOf { kNone, kOwn, kOwnAndEarlier };

// What weighs a tap.
template <bool kGeometryWeighs, LightOf kLightOf>
struct Weighing {
  static constexpr bool kGeometry = kGeometryWeighs, kLight = kLightOf != LightOf::kNone;
  static constexpr bool kEarlier = kLightOf == LightOf::kOwnAndEarlier;
};

// The planes that a vector of output pixels lies in.
struct Tangents {
  VF normal[3];
  VF x, y, c;   // N . ray(column, line) = x column + y line + c
  VF distance;  // N . (X - eye)
  VF scale;     // 1 / (8 plane_distance depth)
};

HWY_INLINE Tangents LoadTangents(const AtrousPass& pass, int x, int y) {
  const F d;
  const Camera& camera = pass.guides.camera;
  const glm::mat3& to_view = camera.world_to_view;
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  Tangents at;
  for (std::size_t c = 0; c < 3; ++c) at.normal[c] = load(pass.guides.surface.normal[c]);
  const auto view_normal = [&](int r) {
    VF v = hn::Mul(hn::Set(d, to_view[0][r]), at.normal[0]);
    v = hn::MulAdd(hn::Set(d, to_view[1][r]), at.normal[1], v);
    return hn::MulAdd(hn::Set(d, to_view[2][r]), at.normal[2], v);
  };
  const VF inverse_focal = hn::Set(d, 1.0f / camera.focal);
  at.x = hn::Mul(view_normal(0), inverse_focal);
  at.y = hn::Mul(view_normal(1), inverse_focal);
  at.c = hn::NegMulAdd(at.x, hn::Set(d, camera.center.x - 0.5f),
                       hn::NegMulAdd(at.y, hn::Set(d, camera.center.y - 0.5f), view_normal(2)));
  const VF depth = load(pass.guides.surface.depth);
  const VF column = hn::Iota(d, static_cast<float>(x));
  const VF line = hn::Set(d, static_cast<float>(y));
  at.distance = hn::Mul(depth, hn::MulAdd(at.x, column, hn::MulAdd(at.y, line, at.c)));
  // A depth that is none must not turn the decay into a growth: it leaves no valid tap.
  const VF tolerance = hn::Mul(hn::Set(d, pass.options.plane_distance), depth);
  at.scale = hn::Div(hn::Set(d, 0.125f), hn::Max(tolerance, hn::Zero(d)));
  return at;
}

// The light of the output pixels.
struct Light {
  VF luminance, earlier;
  // An eighth over what is tolerated of them.
  VF scale, earlier_scale;
};

// 1 / (8 (sigmas sigma + share |luminance|))
HWY_INLINE VF LightScale(float sigmas, VF sigma, float share, VF luminance) {
  const F d;
  const VF tolerance =
      hn::MulAdd(hn::Set(d, sigmas), sigma, hn::Mul(hn::Set(d, share), hn::Abs(luminance)));
  // 1e-20 only keeps black on black from dividing by zero.
  return hn::Div(hn::Set(d, 0.125f), hn::Add(tolerance, hn::Set(d, 1e-20f)));
}

// What is not known does not count.
HWY_INLINE VF KnownOrZero(VF v) { return hn::IfThenZeroElse(hn::IsNaN(v), v); }

template <typename By>
HWY_INLINE Light LoadLight(const AtrousPass& pass, int x, int y, VF smooth_variance) {
  const F d;
  const auto load = [&](std::size_t c) { return hn::LoadU(d, pass.color[c].row(y) + x); };
  const AtrousOptions& options = pass.options;
  const VF sigma = hn::Sqrt(smooth_variance);
  Light light;
  light.luminance = Luminance(load(0), load(1), load(2));
  light.scale = LightScale(options.luminance_sigmas, sigma, 1e-4f, light.luminance);
  if constexpr (By::kEarlier) {
    light.earlier = hn::LoadU(d, pass.earlier->row(y) + x);
    light.earlier_scale = KnownOrZero(
        LightScale(options.earlier_sigmas, sigma, options.earlier_share, light.earlier));
  }
  return light;
}

// What the output pixels have gathered.
struct Sums {
  VF color[3], weight, variance;
};

// The center tap always counts, whatever its normal.
HWY_INLINE Sums LoadCenter(const AtrousPass& pass, int x, int y) {
  const F d;
  const VF own = hn::Set(d, Weight(pass, 0, 0));
  const auto load = [&](const Plane<float>& plane) { return hn::LoadU(d, plane.row(y) + x); };
  Sums sums;
  for (std::size_t c = 0; c < 3; ++c) sums.color[c] = hn::Mul(own, load(pass.color[c]));
  sums.weight = own;
  sums.variance = hn::Mul(hn::Mul(own, own), load(pass.variance));
  return sums;
}

// The planes of one row of taps.
struct TapRow {
  const float *color[3], *variance, *normal[3], *depth, *earlier;
  int line, dy;     // which row of the image, and of the kernel
  float kernel[5];  // h of its taps

  TapRow() = default;
  TapRow(const AtrousPass& pass, int y, int place)
      : color{pass.color[0].row(y), pass.color[1].row(y), pass.color[2].row(y)},
        variance(pass.variance.row(y)),
        normal{pass.guides.surface.normal[0].row(y), pass.guides.surface.normal[1].row(y),
               pass.guides.surface.normal[2].row(y)},
        depth(pass.guides.surface.depth.row(y)),
        earlier(pass.earlier != nullptr ? pass.earlier->row(y) : nullptr),
        line(y),
        dy(place) {
    const int radius = pass.options.radius;
    for (int j = -radius; j <= radius; ++j) kernel[j + radius] = Weight(pass, j, place);
  }
};

// Taps of a vector of output pixels at column x that all lie within the columns of the image.
struct InnerTaps {
  int x, step;

  [[nodiscard]] HWY_INLINE VF Load(const float* source, int j) const {
    return hn::LoadU(F(), source + x + j * step);
  }
  [[nodiscard]] HWY_INLINE VF Kernel(float weight, int) const { return hn::Set(F(), weight); }
};

// Taps of which some lie beside the image: those are 0 and weigh nothing.
struct EdgeTaps {
  int x, step, last;

  // Of the columns from the j-th tap of the first pixel on.
  [[nodiscard]] hn::Mask<F> IsInside(int j) const {
    const F d;
    const VF column = hn::Iota(d, static_cast<float>(x + j * step));
    return hn::And(hn::Ge(column, hn::Zero(d)),
                   hn::Le(column, hn::Set(d, static_cast<float>(last))));
  }
  // A vector that touches the row reads no further beside it than planes allow.
  [[nodiscard]] VF Load(const float* source, int j) const {
    const F d;
    const int first = x + j * step;
    if (first + static_cast<int>(hn::Lanes(d)) <= 0 || first > last) return hn::Zero(d);
    return hn::IfThenElseZero(IsInside(j), hn::LoadU(d, source + first));
  }
  [[nodiscard]] VF Kernel(float weight, int j) const {
    return hn::IfThenElseZero(IsInside(j), hn::Set(F(), weight));
  }
};

// Taps of which those beside the image are its first or last pixel.
struct RepeatedTaps {
  int x, last;

  [[nodiscard]] VF Load(const float* source, int j) const {
    alignas(64) float values[64];
    for (int l = 0; l < static_cast<int>(hn::Lanes(F())); ++l) {
      values[l] = source[std::clamp(x + j + l, 0, last)];
    }
    return hn::Load(F(), values);
  }
};

// Variance of luminance around a vector of pixels of row y: 3 x 3 binomial, edges repeated.
template <typename Taps>
HWY_INLINE VF SmoothVariance(const Plane<float>& variance, const Taps& taps, int y) {
  const F d;
  const VF two = hn::Set(d, 2.0f);
  const float* upper = variance.row(std::max(y - 1, 0));
  const float* middle = variance.row(y);
  const float* lower = variance.row(std::min(y + 1, variance.height() - 1));
  const auto column = [&](int j) {
    return hn::MulAdd(two, taps.Load(middle, j), hn::Add(taps.Load(upper, j), taps.Load(lower, j)));
  };
  return hn::Mul(hn::Set(d, 1.0f / 16.0f),
                 hn::MulAdd(two, column(0), hn::Add(column(-1), column(1))));
}

// Which taps load is decided vector by vector: bits do not hang on how wide a tile is.
HWY_INLINE VF SmoothVariance(const Plane<float>& variance, int x, int y) {
  const int last = variance.width() - 1;
  return x > 0 && x + static_cast<int>(hn::Lanes(F())) <= last
             ? SmoothVariance(variance, InnerTaps{x, 1}, y)
             : SmoothVariance(variance, RepeatedTaps{x, last}, y);
}

// The eighth root of the weight of geometry: (N_p . N_q)^8 (1 - distance off the plane / 8).
template <typename Taps>
HWY_INLINE VF GeometryRoot(const TapRow& row, const Taps& taps, int j, VF along_row,
                           const Tangents& at) {
  const F d;
  const VF along = hn::MulAdd(at.x, hn::Set(d, static_cast<float>(j * taps.step)), along_row);
  const VF off = hn::Abs(hn::MulSub(along, taps.Load(row.depth, j), at.distance));
  const VF decay = hn::NegMulAdd(off, at.scale, hn::Set(d, 1.0f));
  VF cosine = hn::Mul(at.normal[0], taps.Load(row.normal[0], j));
  cosine = hn::MulAdd(at.normal[1], taps.Load(row.normal[1], j), cosine);
  cosine = hn::MulAdd(at.normal[2], taps.Load(row.normal[2], j), cosine);
  // Sky has infinite depth and so NaN or -inf here: the comparison fails. So do normals that are no
  // unit vectors, whose 64th power would be Inf.
  const auto valid =
      hn::And(hn::Gt(decay, hn::Zero(d)),
              hn::And(hn::Gt(cosine, hn::Zero(d)), hn::Le(cosine, hn::Set(d, kLargestCosine))));
  for (int s = 0; s < 3; ++s) cosine = hn::Mul(cosine, cosine);
  return hn::IfThenElseZero(valid, hn::Mul(cosine, decay));
}

// Adds taps that weigh as much as the eighth power of `root`, and of what light makes of it.
template <typename By, typename Taps>
HWY_INLINE void AddTap(const TapRow& row, const Taps& taps, int j, VF root, VF kernel,
                       const Light& at, Sums& sums) {
  const F d;
  const VF color[3] = {taps.Load(row.color[0], j), taps.Load(row.color[1], j),
                       taps.Load(row.color[2], j)};
  if constexpr (By::kLight) {
    const VF off = hn::Abs(hn::Sub(Luminance(color[0], color[1], color[2]), at.luminance));
    VF decay = hn::NegMulAdd(off, at.scale, hn::Set(d, 1.0f));
    if constexpr (By::kEarlier) {
      const VF earlier_off = hn::Abs(hn::Sub(taps.Load(row.earlier, j), at.earlier));
      decay = hn::NegMulAdd(KnownOrZero(earlier_off), at.earlier_scale, decay);
    }
    const VF kept = hn::IfThenElseZero(hn::Gt(decay, hn::Zero(d)), decay);
    root = By::kGeometry ? hn::Mul(root, kept) : kept;
  }
  VF w = kernel;
  if constexpr (By::kLight || By::kGeometry) {
    for (int s = 0; s < 3; ++s) root = hn::Mul(root, root);
    w = hn::Mul(kernel, root);
  }
  for (int c = 0; c < 3; ++c) sums.color[c] = hn::MulAdd(w, color[c], sums.color[c]);
  sums.weight = hn::Add(sums.weight, w);
  sums.variance = hn::MulAdd(hn::Mul(w, w), taps.Load(row.variance, j), sums.variance);
}

// Writes the lanes whose pixels show a surface; the others keep their value. Lanes beyond the row
// write its padding.
HWY_INLINE void StoreCenter(const AtrousPass& pass, const Sums& sums, int x, int y) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const auto id = hn::LoadU(du, pass.guides.surface.id.row(y) + x);
  const auto surface = hn::RebindMask(d, hn::Ne(id, hn::Zero(du)));
  const VF scale = hn::Div(hn::Set(d, 1.0f), sums.weight);
  const auto store = [&](VF value, const Plane<float>& from, Plane<float>& to) {
    hn::StoreU(hn::IfThenElse(surface, value, hn::LoadU(d, from.row(y) + x)), d, to.row(y) + x);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    store(hn::Mul(sums.color[c], scale), pass.color[c], pass.out_color[c]);
  }
  store(hn::Mul(sums.variance, hn::Mul(scale, scale)), pass.variance, pass.out_variance);
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

// One vector of output pixels. All of geometry first: what it needs and what light and sums need
// does not fit 16 registers at once.
template <int kRadius, typename By, typename Taps>
HWY_INLINE void FilterVector(const AtrousPass& pass, std::span<const TapRow> rows, const Taps& taps,
                             int y, VF smooth_variance) {
  const F d;
  constexpr int kSide = 2 * kRadius + 1;
  VF root[kSide][kSide];
  if constexpr (By::kGeometry) {
    const Tangents planes = LoadTangents(pass, taps.x, y);
    const VF column = hn::Iota(d, static_cast<float>(taps.x));
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const VF line = hn::Set(d, static_cast<float>(rows[r].line));
      const VF along = hn::MulAdd(planes.x, column, hn::MulAdd(planes.y, line, planes.c));
      for (int j = -kRadius; j <= kRadius; ++j) {
        root[r][j + kRadius] = GeometryRoot(rows[r], taps, j, along, planes);
      }
    }
  }
  Light light;
  if constexpr (By::kLight) light = LoadLight<By>(pass, taps.x, y, smooth_variance);
  Sums sums = LoadCenter(pass, taps.x, y);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (int j = -kRadius; j <= kRadius; ++j) {
      if (j == 0 && rows[r].dy == 0) continue;
      AddTap<By>(rows[r], taps, j, root[r][j + kRadius],
                 taps.Kernel(rows[r].kernel[j + kRadius], j), light, sums);
    }
  }
  StoreCenter(pass, sums, taps.x, y);
}

template <int kRadius, LightOf kLightOf>
void FilterTile(const AtrousPass& pass, const Rect& tile) {
  using Full = Weighing<true, kLightOf>;
  using Planar = Weighing<false, kLightOf>;
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d)), reach = kRadius * pass.step;
  constexpr int kSide = PlanarBlocks::kSide;
  const int margin = (reach + kSide - 1) / kSide;
  const Extent extent = pass.variance.extent();
  for (int y = tile.y0; y < tile.y1; ++y) {
    TapRow found[2 * kRadius + 1];
    const std::span<const TapRow> rows(found,
                                       static_cast<std::size_t>(FindRows<kRadius>(pass, y, found)));
    const std::uint8_t* margins = pass.planar.margins(y / kSide);
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      const VF variance = Full::kLight ? SmoothVariance(pass.variance, x, y) : hn::Zero(d);
      const int last = std::min(x + lanes, extent.width) - 1;
      if (x - reach < 0 || x + lanes + reach > extent.width) {
        FilterVector<kRadius, Full>(pass, rows, EdgeTaps{x, pass.step, extent.width - 1}, y,
                                    variance);
      } else if (std::min(margins[x / kSide], margins[last / kSide]) >= margin) {
        FilterVector<kRadius, Planar>(pass, rows, InnerTaps{x, pass.step}, y, variance);
      } else {
        FilterVector<kRadius, Full>(pass, rows, InnerTaps{x, pass.step}, y, variance);
      }
    }
  }
}

template <LightOf kLightOf>
void FilterTile(const AtrousPass& pass, const Rect& tile) {
  pass.options.radius == 1 ? FilterTile<1, kLightOf>(pass, tile)
                           : FilterTile<2, kLightOf>(pass, tile);
}

void AtrousTile(const AtrousPass& pass, const Rect& tile) {
  if (!pass.options.looks_at_light()) {
    FilterTile<LightOf::kNone>(pass, tile);
  } else if (pass.earlier == nullptr) {
    FilterTile<LightOf::kOwn>(pass, tile);
  } else {
    FilterTile<LightOf::kOwnAndEarlier>(pass, tile);
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
