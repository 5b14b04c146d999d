#include <algorithm>
#include <cstdint>

#include "spatial/soft_atrous_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/soft_atrous_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/soft_atrous-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

struct GuideRow {
  const float* guide[kSoftGuides];

  GuideRow() = default;
  GuideRow(const SoftGuides& guides, int y) {
    for (std::size_t i = 0; i < kSoftGuides; ++i) guide[i] = guides[i].row(y);
  }
};

// Weights of geometry between the pixels from x on and those j steps along another row.
template <class Taps>
HWY_INLINE VF Geometry(const GuideRow& here, int x, const GuideRow& there, const Taps& taps,
                       int j) {
  VF square = Zero();
  for (std::size_t i = 0; i < kSoftGuides; ++i) {
    const VF d = Sub(LoadU(F(), here.guide[i] + x), taps.Load(there.guide[i], j));
    square = Add(square, Mul(d, d));
  }
  return SoftFalloff(square);
}

void NearRow(const SoftGuides& guides, int y, std::vector<Plane<float>>& near) {
  constexpr int kNear[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  const int width = guides[0].width();
  const GuideRow here(guides, y);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const int j = kNear[i][0], line = y + kNear[i][1];
    if (line >= guides[0].height()) continue;
    const GuideRow there(guides, line);
    ForEachSoftVector(0, width, width, 1, 1, [&](int x, const auto& taps) {
      Store(Mul(taps.Kernel(1.0f, j), Geometry(here, x, there, taps, j)), near[i], x, y);
    });
  }
}

// Taps of a row of pixels in all rows of the image that they meet.
struct SoftTaps {
  static constexpr int kMostLines = 5, kMost = 24;
  struct Tap {
    int line, j;  // line: of those below
    float kernel;
  };

  int lines = 0, count = 0;
  int y[kMostLines];
  GuideRow guides[kMostLines];
  Tap tap[kMost];
  float center;

  SoftTaps(const SoftPass& pass, int row) {
    constexpr float kBinomial[3] = {0.25f, 0.5f, 0.25f};
    constexpr float kSpline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};
    const int radius = pass.radius;
    const float* kernel = (radius == 1 ? kBinomial : kSpline) + radius;
    center = kernel[0] * kernel[0];
    for (int dy = -radius; dy <= radius; ++dy) {
      const int line = row + dy * pass.step;
      if (line < 0 || line >= pass.guides[0].height()) continue;
      for (int j = -radius; j <= radius; ++j) {
        if (j != 0 || dy != 0) tap[count++] = {lines, j, kernel[j] * kernel[dy]};
      }
      guides[lines] = GuideRow(pass.guides, line);
      y[lines++] = line;
    }
  }
};

// Part of a row, and of each of its vectors the taps whose weights of geometry are not all 0.
struct SoftChunk {
  static constexpr int kPixels = 64;
  int y, x0, x1;
  int count[kPixels];  // of the vector at x0 + i
  std::uint8_t tap[kPixels * SoftTaps::kMost];
  alignas(64) float weight[kPixels * SoftTaps::kMost];
};

void ShareGeometry(const SoftPass& pass, const SoftTaps& taps, SoftChunk& chunk) {
  const GuideRow here(pass.guides, chunk.y);
  float* weight = chunk.weight;
  std::uint8_t* tap = chunk.tap;
  const auto visit = [&](int x, const auto& at) {
    int& count = chunk.count[x - chunk.x0] = 0;
    for (int t = 0; t < taps.count; ++t) {
      const SoftTaps::Tap& to = taps.tap[t];
      const VF w =
          Mul(at.Kernel(to.kernel, to.j), Geometry(here, x, taps.guides[to.line], at, to.j));
      if (AllFalse(F(), Gt(w, Zero()))) continue;
      Store(w, F(), weight);
      *tap++ = static_cast<std::uint8_t>(t);
      weight += LaneCount();
      ++count;
    }
  };
  ForEachSoftVector(chunk.x0, chunk.x1, pass.guides[0].width(), pass.radius, pass.step, visit);
}

// One row of a layer.
struct SoftLine {
  const float *light[3], *variance, *mean, *tolerance, *usable;

  SoftLine() = default;
  SoftLine(const SoftWork& work, int y)
      : light{(*work.light)[0].row(y), (*work.light)[1].row(y), (*work.light)[2].row(y)},
        variance(work.variance->row(y)),
        mean(work.mean->row(y)),
        tolerance(work.tolerance->row(y)),
        usable(work.usable->row(y)) {}
};

struct SoftSums {
  VF weight;
  VF3 light;
  VF variance;
};

HWY_INLINE void AddWeighted(VF w, const VF3& light, VF variance, SoftSums& sums) {
  sums.weight = Add(sums.weight, w);
  for (int c = 0; c < 3; ++c) sums.light[c] = Add(sums.light[c], Mul(w, light[c]));
  sums.variance = Add(sums.variance, Mul(Mul(w, w), variance));
}

// A tap of weight w by kernel and geometry.
template <bool kFirst, class Taps>
HWY_INLINE void AddTap(const SoftLine& to, const Taps& taps, int j, VF mean, VF tolerance, VF w,
                       SoftSums& sums) {
  if constexpr (kFirst) w = Mul(w, taps.Load(to.usable, j));
  const VF apart = Abs(Sub(mean, taps.Load(to.mean, j)));
  w = Mul(w, SoftFalloff(Div(apart, Add(tolerance, taps.Load(to.tolerance, j)))));
  const VF3 light = {
      {taps.Load(to.light[0], j), taps.Load(to.light[1], j), taps.Load(to.light[2], j)}};
  AddWeighted(w, light, taps.Load(to.variance, j), sums);
}

HWY_INLINE void StoreFiltered(const SoftPass& pass, const SoftWork& work, SoftSums sums, int x,
                              int y) {
  const VF over = SoftInverse(sums.weight, SoftSurface(pass.guides, x, y));
  for (int c = 0; c < 3; ++c) sums.light[c] = Mul(sums.light[c], over);
  Store(sums.light, *work.out_light, x, y);
  Store(Mul(Mul(sums.variance, over), over), *work.out_variance, x, y);
  Store(SoftLuminance(sums.light), *work.luminance, x, y);
}

template <bool kFirst>
void FilterLayer(const SoftPass& pass, const SoftTaps& taps, const SoftChunk& chunk,
                 const SoftWork& work) {
  SoftLine lines[SoftTaps::kMostLines];
  for (int i = 0; i < taps.lines; ++i) lines[i] = SoftLine(work, taps.y[i]);
  const int y = chunk.y;
  const float* weight = chunk.weight;
  const std::uint8_t* tap = chunk.tap;
  const auto visit = [&](int x, const auto& at) {
    const VF mean = Load(*work.mean, x, y), tolerance = Load(*work.tolerance, x, y);
    VF own = Set(taps.center);
    if constexpr (kFirst) own = Mul(own, Load(*work.usable, x, y));
    // From 0 on: no sum is -0, and taps of weight 0 change nothing.
    SoftSums sums{Zero(), {{Zero(), Zero(), Zero()}}, Zero()};
    AddWeighted(own, Load(*work.light, x, y), Load(*work.variance, x, y), sums);
    for (int i = chunk.count[x - chunk.x0]; i > 0; --i, ++tap, weight += LaneCount()) {
      const SoftTaps::Tap& to = taps.tap[*tap];
      AddTap<kFirst>(lines[to.line], at, to.j, mean, tolerance, Load(F(), weight), sums);
    }
    StoreFiltered(pass, work, sums, x, y);
  };
  ForEachSoftVector(chunk.x0, chunk.x1, pass.guides[0].width(), pass.radius, pass.step, visit);
}

void FilterRow(const SoftPass& pass, int y) {
  const int width = pass.guides[0].width();
  const SoftTaps taps(pass, y);
  SoftChunk chunk;
  chunk.y = y;
  for (chunk.x0 = 0; chunk.x0 < width; chunk.x0 += SoftChunk::kPixels) {
    chunk.x1 = std::min(chunk.x0 + SoftChunk::kPixels, width);
    ShareGeometry(pass, taps, chunk);
    for (const SoftWork& work : pass.work) {
      if (pass.is_first) {
        FilterLayer<true>(pass, taps, chunk, work);
      } else {
        FilterLayer<false>(pass, taps, chunk, work);
      }
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(NearRow);
HWY_EXPORT(FilterRow);

void soft_near_row(const SoftGuides& guides, int y, std::vector<Plane<float>>& near) {
  HWY_DYNAMIC_DISPATCH(NearRow)(guides, y, near);
}

void soft_filter_row(const SoftPass& pass, int y) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(FilterRow)(pass, y);
}

}  // namespace eigenlight
#endif
