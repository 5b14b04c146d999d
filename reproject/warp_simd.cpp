#include <algorithm>

#include "frame/prefetch.h"
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

using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;

// Whether the taps of a vector stand side by side, all inside the image: taps beside it have been
// moved to its edge, where a pixel's own two may be one.
bool IsRun(const TapSegment& taps, std::size_t i) {
  const I di;
  const auto x = hn::Load(di, taps.x[0].data() + i), y = hn::Load(di, taps.y[0].data() + i);
  const auto one = hn::Set(di, 1);
  const auto beside = hn::Eq(hn::Load(di, taps.x[1].data() + i), hn::Add(x, one));
  const auto below = hn::Eq(hn::Load(di, taps.y[2].data() + i), hn::Add(y, one));
  const auto along = hn::Eq(hn::Sub(x, hn::Iota(di, 0)), hn::Set(di, taps.x[0][i]));
  const auto level = hn::Eq(y, hn::Set(di, taps.y[0][i]));
  return hn::AllTrue(di, hn::And(hn::And(beside, below), hn::And(along, level)));
}

void WarpPlane(const Plane<float>& from, const TapSegment& taps, const Tile& row,
               Plane<float>& to) {
  const F d;
  const std::size_t lanes = hn::Lanes(d), count = static_cast<std::size_t>(row.x1 - row.x0);
  float* out = to.at(row.x0, row.y0);
  for (std::size_t i = 0; i < count; i += lanes) {
    prefetch_below(to, row.x0 + static_cast<int>(i), row.y0);
    if (IsRun(taps, i)) {
      const int x = taps.x[0][i], y = taps.y[0][i];
      prefetch_below(from, x, y + 1);
      auto sum = hn::Zero(d);
      for (int t = 0; t < 4; ++t) {
        const auto weight = hn::Load(d, taps.weight[static_cast<std::size_t>(t)].data() + i);
        sum = hn::MulAdd(weight, hn::LoadU(d, from.row(y + t / 2) + x + t % 2), sum);
      }
      hn::StoreU(sum, d, out + i);
      continue;
    }
    for (std::size_t j = i; j < std::min(i + lanes, count); ++j) {
      float sum = 0.0f;
      for (std::size_t t = 0; t < 4; ++t) {
        sum += taps.weight[t][j] * from(taps.x[t][j], taps.y[t][j]);
      }
      out[j] = sum;
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(WarpBases);
HWY_EXPORT(WarpPlane);

void warp_bases(const BasisField& from, const TapSegment& taps, const Tile& row, BasisField& to) {
  EL_DCHECK(from.bases() == to.bases() && row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(WarpBases)(from, taps, row, to);
}

void warp_plane(const Plane<float>& from, const TapSegment& taps, const Tile& row,
                Plane<float>& to) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(WarpPlane)(from, taps, row, to);
}

}  // namespace eigenlight
#endif
