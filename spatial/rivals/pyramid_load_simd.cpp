#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/rivals/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/pyramid_load_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;

// As in pyramid.h: sums of 18 such values, whose weights are at most 1, stay finite.
constexpr float kLargestValue = 1e36f;

// Two visits to a row of the image: all nine planes at once are one more than the eight lines that
// the first-level cache has for addresses a page apart, as those of planes are.

// A vector of the surface; normal and depth are 0 where there is none.
void LoadSurface(const GBuffer& surface, int x, int y, MF inside, float* (&to)[kPyramidChannels]) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const auto id = hn::MaskedLoad(hn::RebindMask(du, inside), du, surface.id.row(y) + x);
  const VF depth = hn::MaskedLoad(inside, d, surface.depth.row(y) + x);
  MF exists = hn::And(hn::RebindMask(d, hn::Ne(id, hn::Zero(du))),
                      hn::And(hn::Gt(depth, hn::Zero(d)), hn::IsFinite(depth)));
  VF normal[3];
  for (std::size_t c = 0; c < 3; ++c) {
    normal[c] = hn::MaskedLoad(inside, d, surface.normal[c].row(y) + x);
    exists = hn::And(exists, hn::IsFinite(normal[c]));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    hn::StoreU(hn::IfThenElseZero(exists, normal[c]), d, to[kNormal + c]);
  }
  hn::StoreU(hn::IfThenElseZero(exists, depth), d, to[kDepth]);
}

// Light where a surface has been loaded; no sample, no light.
void LoadSignal(const PyramidImage& image, int x, int y, MF inside,
                float* (&to)[kPyramidChannels]) {
  const F d;
  const VF most = hn::Set(d, kLargestValue);
  const VF weight = hn::MaskedLoad(inside, d, image.weight.row(y) + x);
  MF used = hn::And(hn::Gt(hn::LoadU(d, to[kDepth]), hn::Zero(d)),
                    hn::And(hn::Gt(weight, hn::Zero(d)), hn::Lt(weight, most)));
  VF value[3];
  for (std::size_t c = 0; c < 3; ++c) {
    value[c] = hn::Mul(weight, hn::MaskedLoad(inside, d, image.signal[c].row(y) + x));
    used = hn::And(used, hn::Lt(hn::Abs(value[c]), most));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    hn::StoreU(hn::IfThenElseZero(used, value[c]), d, to[kRed + c]);
  }
  hn::StoreU(hn::IfThenElseZero(used, weight), d, to[kWeight]);
}

void LoadPlanes(const PyramidPlanes& planes, int x, int y, MF inside,
                float* (&to)[kPyramidChannels]) {
  const F d;
  const auto copy = [&](const Plane<float>& plane, float* target) {
    hn::StoreU(hn::MaskedLoad(inside, d, plane.row(y) + x), d, target);
  };
  for (std::size_t c = 0; c < 4; ++c) copy(planes.values[c], to[kRed + c]);
  for (std::size_t c = 0; c < 3; ++c) copy(planes.normal[c], to[kNormal + c]);
  copy(planes.depth, to[kDepth]);
}

// Pixels [x0, x1) of row y, in whole vectors.
void LoadRow(const PyramidView& view, int x0, int x1, int y, float* (&row)[kPyramidChannels]) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto run = [&](const auto& load) {
    float* to[kPyramidChannels];
    std::copy(std::begin(row), std::end(row), to);
    for (int x = x0; x < x1; x += lanes) {
      load(x, hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, x1 - x))), to);
      for (float*& channel : to) channel += lanes;
    }
  };
  if (view.planes) {
    run([&](int x, MF inside, auto& to) { LoadPlanes(*view.planes, x, y, inside, to); });
  } else {
    run([&](int x, MF inside, auto& to) { LoadSurface(view.image.surface, x, y, inside, to); });
    run([&](int x, MF inside, auto& to) { LoadSignal(view.image, x, y, inside, to); });
  }
}

void LoadBlock(const PyramidView& view, int x0, int y0, int border, PyramidFineBlock& block) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  const Extent extent = view.extent();
  const int end = x0 + kPyramidTileWidth + border;
  // Whole vectors, so that loads are aligned.
  const int first = std::max(x0 - border * lanes, 0), last = std::min(end, extent.width);
  for (int r = 1 - border; r < kPyramidTileHeight + 1 + border; ++r) {
    float* row[kPyramidChannels];
    for (int c = 0; c < kPyramidChannels; ++c) row[c] = block.data[c][r] + kPyramidMargin;
    const int y = y0 - 1 + r;
    const bool inside = y >= 0 && y < extent.height;
    for (float*& to : row) {
      to[-1] = 0.0f;
      std::fill(inside ? to + last - x0 : to, to + end - x0, 0.0f);
      to += first - x0;
    }
    if (inside) LoadRow(view, first, last, y, row);
  }
}

// Every value twice.
void SpreadRow(const float* from, int count, float* to) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const VF v = hn::LoadU(d, from + i);
    hn::StoreInterleaved2(v, v, d, to + 2 * i);
  }
  for (; i < count; ++i) to[2 * i] = to[2 * i + 1] = from[i];
}

void LoadCoarse(const PyramidPlanes& planes, const Rect& tile, PyramidCoarseBlock& block) {
  const int x0 = tile.x0 / 2 - 1, y0 = tile.y0 / 2 - 1;
  const Extent extent = planes.depth.extent();
  const int end = tile.x0 / 2 + kPyramidTileWidth / 2 + 1;
  const int first = std::max(x0, 0), last = std::min(end, extent.width);
  const auto spread = [&](const Plane<float>& plane, int channel, int r) {
    float* to = block.data[channel][r] + kPyramidMargin - 2;  // of column x0
    const bool inside = y0 + r >= 0 && y0 + r < extent.height;
    std::fill_n(to, 2 * (inside ? first - x0 : end - x0), 0.0f);
    if (!inside) return;
    SpreadRow(plane.row(y0 + r) + first, last - first, to + 2 * (first - x0));
    std::fill(to + 2 * (last - x0), to + 2 * (end - x0), 0.0f);
  };
  for (int r = 0; r < kPyramidTileHeight / 2 + 2; ++r) {
    for (int c = 0; c < 4; ++c) spread(planes.result[static_cast<std::size_t>(c)], kRed + c, r);
    for (int c = 0; c < 3; ++c) spread(planes.normal[static_cast<std::size_t>(c)], kNormal + c, r);
    spread(planes.depth, kDepth, r);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(LoadBlock);
HWY_EXPORT(LoadCoarse);

void load_pyramid_block(const PyramidView& level, int x0, int y0, int border,
                        PyramidFineBlock& block) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadBlock)(level, x0, y0, border, block);
}

void load_coarser_block(const PyramidPlanes& level, const Rect& tile, PyramidCoarseBlock& block) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadCoarse)(level, tile, block);
}

}  // namespace eigenlight
#endif
