#include <algorithm>
#include <cstring>
#include <limits>

#include "frame/float_traps.h"
#include "frame/usable_surface.h"
#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_rows_simd.cpp"
// Not in alphabetical order: foreach_target.h has to come first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, kGuidedBlock>;
using VF = hn::Vec<F>;

// One row of a plane, zero outside the image.
template <typename T>
void CopyRow(const Plane<T>& plane, const GuidedColumns& columns, int y, Plane<T>& to) {
  std::fill_n(to.row(0), columns.width, T{0});
  const int x0 = std::max(columns.left, 0);
  const int x1 = std::min(columns.left + columns.width, plane.width());
  if (x0 >= x1) return;
  std::memcpy(to.at(x0 - columns.left, 0), plane.at(x0, y),
              static_cast<std::size_t>(x1 - x0) * sizeof(T));
}

struct RowMasks {
  hn::Mask<F> surface, used;
};

RowMasks MasksAt(const GuidedRow& row, int x) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const VF zero = hn::Zero(d), largest = hn::Set(d, std::numeric_limits<float>::max());
  const auto load = [&](const Plane<float>& plane) { return hn::Load(d, plane.row(0) + x); };
  const auto finite = [&](VF v) { return hn::Le(hn::Abs(v), largest); };
  const auto id = hn::Load(du, row.id.row(0) + x);
  const VF depth = load(row.depth), weight = load(row.weight);
  RowMasks masks;
  masks.surface = hn::RebindMask(d, hn::Ne(id, hn::Zero(du)));
  masks.surface = hn::And(masks.surface, hn::And(hn::Ge(depth, hn::Set(d, kNearestDepth)),
                                                 hn::Le(depth, hn::Set(d, kFarthestDepth))));
  for (const auto& plane : row.normal) {
    const VF normal = hn::Abs(load(plane));
    masks.surface = hn::And(masks.surface, hn::Le(normal, hn::Set(d, kLargestNormal)));
  }
  masks.used = hn::And(masks.surface, hn::And(hn::Gt(weight, zero), finite(weight)));
  for (const auto& plane : row.signal) masks.used = hn::And(masks.used, finite(load(plane)));
  return masks;
}

VF GuideAt(const GuidedWork& work, const GuidedRow& row, int index, int x) {
  const F d;
  const auto normal = [&](std::size_t c) { return hn::Load(d, row.normal[c].row(0) + x); };
  if (work.options.guides == Guides::kGrayNormal) {
    return hn::MulAdd(
        hn::Set(d, 0.2126f), normal(0),
        hn::MulAdd(hn::Set(d, 0.7152f), normal(1), hn::Mul(hn::Set(d, 0.0722f), normal(2))));
  }
  if (index < 3) return normal(static_cast<std::size_t>(index));
  // 1e-38: lanes that do not count must not cost time as NaN or denormals.
  const VF depth = hn::Max(hn::Load(d, row.depth.row(0) + x), hn::Set(d, 1e-38f));
  return hn::Sub(hn::Log(d, depth), hn::Set(d, work.log_depth));
}

// Turns a row of raw values into weights, guides and weighted signals; what must not count is 0.
void MaskRow(const GuidedWork& work, int width, int y, GuidedScratch& s) {
  const F d;
  const auto guides = static_cast<int>(work.options.guides);
  const int slot = ring_slot(y, s.slots);
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(d))) {
    float* to = s.values.row(x / kGuidedBlock * s.slots + slot) + x % kGuidedBlock;
    const auto put = [&](VF value) {
      hn::Store(value, d, to);
      to += kGuidedBlock;
    };
    const RowMasks masks = MasksAt(s.row, x);
    const VF weight = hn::IfThenElseZero(masks.used, hn::Load(d, s.row.weight.row(0) + x));
    put(weight);
    for (int i = 0; i < guides; ++i) {
      put(hn::IfThenElseZero(masks.surface, GuideAt(work, s.row, i, x)));
    }
    for (const auto& plane : s.row.signal) {
      const VF signal = hn::IfThenElseZero(masks.used, hn::Load(d, plane.row(0) + x));
      put(hn::Mul(weight, signal));
    }
    hn::Store(hn::IfThenElseZero(masks.surface, hn::Set(d, 1.0f)), d, s.surface.row(slot) + x);
  }
}

void ClearRow(int width, int y, GuidedScratch& s) {
  const int slot = ring_slot(y, s.slots);
  for (int block = 0; block < width / kGuidedBlock; ++block) {
    float* row = s.values.row(block * s.slots + slot);
    std::fill_n(row, s.values.width(), 0.0f);
  }
  std::fill_n(s.surface.row(slot), width, 0.0f);
}

void LoadRow(const GuidedWork& work, const GuidedColumns& columns, int y, GuidedScratch& s) {
  if (y < 0 || y >= work.in.weight.height()) return ClearRow(columns.width, y, s);
  const GBuffer& surface = work.in.guides.surface;
  CopyRow(surface.id, columns, y, s.row.id);
  CopyRow(surface.depth, columns, y, s.row.depth);
  CopyRow(work.in.weight, columns, y, s.row.weight);
  for (std::size_t c = 0; c < 3; ++c) {
    CopyRow(surface.normal[c], columns, y, s.row.normal[c]);
    CopyRow(work.in.signal[c], columns, y, s.row.signal[c]);
  }
  MaskRow(work, columns.width, y, s);
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(LoadRow);

void guided_load_row(const GuidedWork& work, const GuidedColumns& columns, int y,
                     GuidedScratch& scratch) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LoadRow)(work, columns, y, scratch);
}

}  // namespace eigenlight
#endif
