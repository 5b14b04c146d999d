#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/pyramid_load_simd.cpp"
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

// Cleans a vector of the image: no surface, no sample.
void LoadImage(const PyramidImage& image, int x, int y, MF inside, float* (&to)[kPyramidChannels]) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const auto load = [&](const Plane<float>& plane) {
    return hn::MaskedLoad(inside, d, plane.row(y) + x);
  };
  const auto id = hn::MaskedLoad(hn::RebindMask(du, inside), du, image.surface.id.row(y) + x);
  const VF depth = load(image.surface.depth);
  VF normal[3];
  MF exists = hn::And(hn::RebindMask(d, hn::Ne(id, hn::Zero(du))),
                      hn::And(hn::Gt(depth, hn::Zero(d)), hn::IsFinite(depth)));
  for (std::size_t c = 0; c < 3; ++c) {
    normal[c] = load(image.surface.normal[c]);
    exists = hn::And(exists, hn::IsFinite(normal[c]));
  }
  const VF weight = load(image.weight), most = hn::Set(d, kLargestValue);
  MF used = hn::And(exists, hn::And(hn::Gt(weight, hn::Zero(d)), hn::Lt(weight, most)));
  VF value[3];
  for (std::size_t c = 0; c < 3; ++c) {
    value[c] = hn::Mul(weight, load(image.signal[c]));
    used = hn::And(used, hn::Lt(hn::Abs(value[c]), most));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    hn::StoreU(hn::IfThenElseZero(used, value[c]), d, to[kRed + c]);
    hn::StoreU(hn::IfThenElseZero(exists, normal[c]), d, to[kNormal + c]);
  }
  hn::StoreU(hn::IfThenElseZero(used, weight), d, to[kWeight]);
  hn::StoreU(hn::IfThenElseZero(exists, depth), d, to[kDepth]);
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

void LoadBlock(const PyramidView& view, int x0, int y0, PyramidFineBlock& block) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Extent extent = view.extent();
  // Whole vectors, so that loads are aligned.
  const int first = std::max(x0 - lanes, 0);
  const int last = std::min(x0 + kPyramidTileWidth + 1, extent.width);
  for (int r = 0; r < kPyramidTileHeight + 2; ++r) {
    float* row[kPyramidChannels];
    for (int c = 0; c < kPyramidChannels; ++c) row[c] = block.data[c][r];
    const int y = y0 - 1 + r;
    if (y < 0 || y >= extent.height) {
      for (float* to : row) std::fill_n(to, PyramidFineBlock::kStride, 0.0f);
      continue;
    }
    for (float*& to : row) {
      std::fill_n(to, kPyramidMargin, 0.0f);
      std::fill(to + kPyramidMargin + last - x0, to + PyramidFineBlock::kStride, 0.0f);
      to += kPyramidMargin + first - x0;
    }
    for (int x = first; x < last; x += lanes) {
      const MF inside = hn::FirstN(d, static_cast<std::size_t>(std::min(lanes, last - x)));
      if (view.planes) {
        LoadPlanes(*view.planes, x, y, inside, row);
      } else {
        LoadImage(view.image, x, y, inside, row);
      }
      for (float*& to : row) to += lanes;
    }
  }
}

void LoadCoarse(const PyramidPlanes& planes, const Tile& tile, PyramidCoarseBlock& block) {
  const int x0 = tile.x0 / 2 - 1, y0 = tile.y0 / 2 - 1;
  const Extent extent = planes.depth.extent();
  const int first = std::max(x0, 0),
            last = std::min(tile.x0 / 2 + kPyramidTileWidth / 2 + 1, extent.width);
  const auto spread = [&](const Plane<float>& plane, int channel, int r) {
    float* to = block.data[channel][r];
    std::fill_n(to, PyramidCoarseBlock::kStride, 0.0f);
    if (y0 + r < 0 || y0 + r >= extent.height) return;
    const float* from = plane.row(y0 + r);
    for (int x = first; x < last; ++x) {
      float* pair = to + kPyramidMargin - 2 + 2 * (x - x0);
      pair[0] = pair[1] = from[x];
    }
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

void load_pyramid_block(const PyramidView& level, int x0, int y0, PyramidFineBlock& block) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadBlock)(level, x0, y0, block);
}

void load_coarser_block(const PyramidPlanes& level, const Tile& tile, PyramidCoarseBlock& block) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadCoarse)(level, tile, block);
}

}  // namespace eigenlight
#endif
