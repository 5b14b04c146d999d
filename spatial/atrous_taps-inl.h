// How the a-trous filter reads the taps of a vector of pixels. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_SPATIAL_ATROUS_TAPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_SPATIAL_ATROUS_TAPS_INL_H_
#undef EIGENLIGHT_SPATIAL_ATROUS_TAPS_INL_H_
#else
#define EIGENLIGHT_SPATIAL_ATROUS_TAPS_INL_H_
#endif

#include <algorithm>

#include "frame/simd-inl.h"
#include "spatial/atrous_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

/// h along one axis, of the taps -1, 0 and 1.
inline constexpr float kAtrousKernel[3] = {1.0f / 4, 1.0f / 2, 1.0f / 4};

/// The geometry of one row of taps.
struct AtrousTapRow {
  const float *normal[3], *depth;
  int line, dy;     // which row of the image, and of the kernel
  float kernel[3];  // h of its taps

  AtrousTapRow() = default;
  AtrousTapRow(const GBuffer& surface, int y, int place)
      : normal{surface.normal[0].row(y), surface.normal[1].row(y), surface.normal[2].row(y)},
        depth(surface.depth.row(y)),
        line(y),
        dy(place) {
    for (int j = 0; j < 3; ++j) kernel[j] = kAtrousKernel[j] * kAtrousKernel[dy + 1];
  }
};

/// The light of one row of taps in one image.
struct AtrousLightRow {
  const float *color[3], *variance, *earlier;

  AtrousLightRow() = default;
  AtrousLightRow(const AtrousWork& work, int y)
      : color{(*work.color)[0].row(y), (*work.color)[1].row(y), (*work.color)[2].row(y)},
        variance(work.variance->row(y)),
        earlier(work.earlier != nullptr ? work.earlier->row(y) : nullptr) {}
};

/// The rows of taps of a row of pixels: fewer than three where the image ends.
struct AtrousTapRows {
  AtrousTapRow row[3];
  AtrousLightRow light[Atrous::kMostImages][3];
  std::size_t count = 0;

  AtrousTapRows(const AtrousPass& pass, int y) {
    for (int dy = -1; dy <= 1; ++dy) {
      const int ty = y + dy * pass.step;
      if (ty < 0 || ty >= pass.guides.extent().height) continue;
      for (std::size_t i = 0; i < pass.work.size(); ++i) {
        light[i][count] = AtrousLightRow(pass.work[i], ty);
      }
      row[count++] = AtrousTapRow(pass.guides.surface, ty, dy);
    }
  }
};

/// Taps of a vector of output pixels at column x that all lie within the columns of the image.
struct InnerTaps {
  int x, step;

  [[nodiscard]] HWY_INLINE VF Load(const float* source, int j) const {
    return LoadU(F(), source + x + j * step);
  }
  [[nodiscard]] HWY_INLINE VF Kernel(float weight, int) const { return Set(weight); }
};

/// Taps of which some lie beside the image: those are 0 and weigh nothing.
struct EdgeTaps {
  int x, step, last;

  /// Of the columns from the j-th tap of the first pixel on.
  [[nodiscard]] MF IsInside(int j) const {
    const VF column = Iota(x + j * step);
    return And(Ge(column, Zero()), Le(column, Set(last)));
  }
  /// A vector that touches the row reads no further beside it than planes allow.
  [[nodiscard]] VF Load(const float* source, int j) const {
    const int first = x + j * step;
    if (first + LaneCount() <= 0 || first > last) return Zero();
    return IfThenElseZero(IsInside(j), LoadU(F(), source + first));
  }
  [[nodiscard]] VF Kernel(float weight, int j) const {
    return IfThenElseZero(IsInside(j), Set(weight));
  }
};

/// Taps of which those beside the image repeat its first or last pixel.
struct RepeatedTaps {
  int x, last;

  [[nodiscard]] VF Load(const float* source, int j) const {
    alignas(64) float values[64];
    for (int l = 0; l < LaneCount(); ++l) values[l] = source[std::clamp(x + j + l, 0, last)];
    return LoadU(F(), values);
  }
};

/// Variance of luminance around a vector of pixels of row y: 3 x 3 binomial, edges repeated.
template <typename Taps>
HWY_INLINE VF SmoothVariance(const Plane<float>& variance, const Taps& taps, int y) {
  const VF two = Set(2);
  const float* upper = variance.row(std::max(y - 1, 0));
  const float* middle = variance.row(y);
  const float* lower = variance.row(std::min(y + 1, variance.height() - 1));
  const auto column = [&](int j) {
    return MulAdd(two, taps.Load(middle, j), Add(taps.Load(upper, j), taps.Load(lower, j)));
  };
  return Mul(Set(1.0f / 16), MulAdd(two, column(0), Add(column(-1), column(1))));
}

/// The kind of taps is chosen vector by vector: results do not depend on the width of a tile.
HWY_INLINE VF SmoothVariance(const Plane<float>& variance, int x, int y) {
  const int last = variance.width() - 1;
  return x > 0 && x + LaneCount() <= last ? SmoothVariance(variance, InnerTaps{x, 1}, y)
                                          : SmoothVariance(variance, RepeatedTaps{x, last}, y);
}

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
