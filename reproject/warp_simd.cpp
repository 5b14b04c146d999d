#include "reproject/warp.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/warp_simd.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// `kWidth` divides the floats of a pixel.
template <int kWidth>
void WarpPixels(const BasisField& from, const TapSegment& taps, const Tile& row, BasisField& to) {
  const hn::CappedTag<float, kWidth> d;
  constexpr int kLine = static_cast<int>(Plane<float>::kLine / sizeof(float));
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int floats = from.pixel_floats();
  const std::size_t stride = from.data().stride();
  const float* base = from.data().row(0);
  float* out = to.pixel(row.x0, row.y0);
  // Rows of a tile are too short for the hardware to foresee the next one: asks for those that the
  // row below will read and write.
  const int last = from.extent().height - 1;
  const std::size_t below = row.y0 < last ? stride : 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(row.x1 - row.x0); ++i, out += floats) {
    const auto pixel = [&](std::size_t t) {
      return base + stride * static_cast<std::size_t>(taps.y[t][i]) + taps.x[t][i] * floats;
    };
    const float* const p[4] = {pixel(0), pixel(1), pixel(2), pixel(3)};
    const float* next = p[2] + (taps.y[2][i] < last ? stride : 0);
    for (int j = 0; j < floats; j += kLine) {
      hwy::Prefetch(next + j);
      hwy::Prefetch(out + below + j);
    }
    const auto w0 = hn::Set(d, taps.weight[0][i]), w1 = hn::Set(d, taps.weight[1][i]);
    const auto w2 = hn::Set(d, taps.weight[2][i]), w3 = hn::Set(d, taps.weight[3][i]);
    for (int j = 0; j < floats; j += lanes) {
      const auto upper = hn::MulAdd(w0, hn::Load(d, p[0] + j), hn::Mul(w1, hn::Load(d, p[1] + j)));
      const auto lower = hn::MulAdd(w2, hn::Load(d, p[2] + j), hn::Mul(w3, hn::Load(d, p[3] + j)));
      hn::Store(hn::Add(upper, lower), d, out + j);
    }
  }
}

// A pixel is a whole number of groups of four floats; the widest vectors that fit.
void WarpBases(const BasisField& from, const TapSegment& taps, const Tile& row, BasisField& to) {
  if (from.pixel_floats() % 16 == 0) {
    WarpPixels<16>(from, taps, row, to);
  } else if (from.pixel_floats() % 8 == 0) {
    WarpPixels<8>(from, taps, row, to);
  } else {
    WarpPixels<4>(from, taps, row, to);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(WarpBases);

void warp_bases(const BasisField& from, const TapSegment& taps, const Tile& row, BasisField& to) {
  EL_DCHECK(from.bases() == to.bases() && row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(WarpBases)(from, taps, row, to);
}

void warp_plane(const Plane<float>& from, const TapSegment& taps, const Tile& row,
                Plane<float>& to) {
  float* out = to.at(row.x0, row.y0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(row.x1 - row.x0); ++i) {
    float sum = 0.0f;
    for (std::size_t t = 0; t < 4; ++t) sum += taps.weight[t][i] * from(taps.x[t][i], taps.y[t][i]);
    out[i] = sum;
  }
}

}  // namespace eigenlight
#endif
