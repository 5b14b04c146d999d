#include <algorithm>

#include "spatial/rivals/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/pyramid_load_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// As in pyramid.h: sums of 18 such values, whose weights are at most 1, stay finite.
constexpr float kLargestValue = 1e36f;

// A vector of pixels, 0 outside the columns of the block.
VF16 LoadInside(MF16 inside, const Plane<float>& plane, int x, int y) {
  return IfThenElseZero(inside, Load(plane, x, y, F16()));
}

// A row of the image is read twice, first the surface, then the signal. All nine planes at once
// would be one more than the eight lines that a first-level cache keeps for addresses a page apart,
// as those of planes may be.

// Normal and depth are 0 where there is no surface.
void LoadSurface(const GBuffer& surface, int x, int y, MF16 inside,
                 float* (&to)[kPyramidChannels]) {
  const F16 d;
  const VF16 depth = LoadInside(inside, surface.depth, x, y);
  MF16 exists =
      And(And(inside, HasSurface(surface.id, x, y, d)), And(Gt(depth, Zero(d)), IsFinite(depth)));
  Vec3<VF16> normal;
  for (int c = 0; c < 3; ++c) {
    normal[c] = LoadInside(inside, surface.normal[c], x, y);
    exists = And(exists, IsFinite(normal[c]));
  }
  for (int c = 0; c < 3; ++c) StoreU(IfThenElseZero(exists, normal[c]), d, to[kNormal + c]);
  StoreU(IfThenElseZero(exists, depth), d, to[kDepth]);
}

// Signal times weight where LoadSurface() found a surface; both 0 without a usable sample.
void LoadSignal(const PyramidImage& image, int x, int y, MF16 inside,
                float* (&to)[kPyramidChannels]) {
  const F16 d;
  const VF16 most = Set(d, kLargestValue);
  const VF16 weight = LoadInside(inside, image.weight, x, y);
  MF16 used = And(Gt(LoadU(d, to[kDepth]), Zero(d)), And(Gt(weight, Zero(d)), Lt(weight, most)));
  Vec3<VF16> value;
  for (int c = 0; c < 3; ++c) {
    value[c] = Mul(weight, LoadInside(inside, image.signal[c], x, y));
    used = And(used, Lt(Abs(value[c]), most));
  }
  for (int c = 0; c < 3; ++c) StoreU(IfThenElseZero(used, value[c]), d, to[kRed + c]);
  StoreU(IfThenElseZero(used, weight), d, to[kWeight]);
}

void LoadPlanes(const PyramidPlanes& planes, int x, int y, MF16 inside,
                float* (&to)[kPyramidChannels]) {
  const auto copy = [&](const Plane<float>& plane, float* target) {
    StoreU(LoadInside(inside, plane, x, y), F16(), target);
  };
  for (int c = 0; c < 4; ++c) copy(planes.values[c], to[kRed + c]);
  for (int c = 0; c < 3; ++c) copy(planes.normal[c], to[kNormal + c]);
  copy(planes.depth, to[kDepth]);
}

// Pixels [x0, x1) of row y, in whole vectors.
void LoadRow(const PyramidView& view, int x0, int x1, int y, float* (&row)[kPyramidChannels]) {
  const F16 d;
  const int lanes = LaneCount(d);
  const auto run = [&](const auto& load) {
    float* to[kPyramidChannels];
    std::copy(std::begin(row), std::end(row), to);
    for (int x = x0; x < x1; x += lanes) {
      load(x, FirstLanes(std::min(lanes, x1 - x), d), to);
      for (float*& channel : to) channel += lanes;
    }
  };
  if (view.planes) {
    run([&](int x, MF16 inside, auto& to) { LoadPlanes(*view.planes, x, y, inside, to); });
  } else {
    run([&](int x, MF16 inside, auto& to) { LoadSurface(view.image.surface, x, y, inside, to); });
    run([&](int x, MF16 inside, auto& to) { LoadSignal(view.image, x, y, inside, to); });
  }
}

void LoadBlock(const PyramidView& view, int x0, int y0, int border, PyramidFineBlock& block) {
  const int lanes = LaneCount(F16());
  const Extent extent = view.extent();
  const int end = x0 + kPyramidTileWidth + border;
  // Whole vectors on the left, where the border needs but one pixel: loads of planes stay aligned.
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
  const F16 d;
  const int lanes = LaneCount(d);
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const VF16 v = LoadU(d, from + i);
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
    for (int c = 0; c < 4; ++c) spread(planes.result[c], kRed + c, r);
    for (int c = 0; c < 3; ++c) spread(planes.normal[c], kNormal + c, r);
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
