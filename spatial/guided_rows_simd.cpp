#include <algorithm>
#include <cstring>

#include "spatial/guided_filter_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/guided_rows_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

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
  MF8 surface, used;
};

RowMasks MasksAt(const GuidedRow& row, int x) {
  const F8 d;
  const VF8 weight = Load(row.weight, x, 0, d);
  const Vec3<VF8> signal = Load(row.signal, x, 0, d);
  RowMasks masks;
  masks.surface = And(HasSurface(row.id, x, 0, d),
                      IsUsable(Load(row.depth, x, 0, d), Load(row.normal, x, 0, d), d));
  masks.used = And(masks.surface, And(Gt(weight, Zero(d)), IsFinite(weight)));
  for (int c = 0; c < 3; ++c) masks.used = And(masks.used, IsFinite(signal[c]));
  return masks;
}

VF8 GuideAt(const GuidedWork& work, const GuidedRow& row, int index, int x) {
  const F8 d;
  if (work.options.guides == Guides::kGrayNormal) return Luminance(Load(row.normal, x, 0, d));
  if (index < 3) return Load(row.normal[index], x, 0, d);
  // Lanes that do not count become 0: NaN and denormals would cost time.
  const VF8 depth = Max(Load(row.depth, x, 0, d), Set(d, 1e-38f));
  return Sub(Log(d, depth), Set(d, work.log_depth));
}

// Turns a row of raw values into weights, guides and weighted signals; 0 where they do not count.
void MaskRow(const GuidedWork& work, int width, int y, GuidedScratch& s) {
  const F8 d;
  const auto guides = static_cast<int>(work.options.guides);
  const int slot = ring_slot(y, s.slots);
  for (int x = 0; x < width; x += LaneCount(d)) {
    float* to = s.values.row(x / kGuidedBlock * s.slots + slot) + x % kGuidedBlock;
    const auto put = [&](VF8 value) {
      Store(value, d, to);
      to += kGuidedBlock;
    };
    const RowMasks masks = MasksAt(s.row, x);
    const VF8 weight = IfThenElseZero(masks.used, Load(s.row.weight, x, 0, d));
    put(weight);
    for (int i = 0; i < guides; ++i) {
      put(IfThenElseZero(masks.surface, GuideAt(work, s.row, i, x)));
    }
    for (const auto& plane : s.row.signal) {
      const VF8 signal = IfThenElseZero(masks.used, Load(plane, x, 0, d));
      put(Mul(weight, signal));
    }
    Store(IfThenElseZero(masks.surface, Set(d, 1.0f)), d, s.surface.row(slot) + x);
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
