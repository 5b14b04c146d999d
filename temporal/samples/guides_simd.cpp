#include "temporal/samples/guides.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/guides_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

PixelCounts CountGuides(const GBuffer& surface, const Rect& row) {
  PixelCounts counts;
  ForEachVector(row, [&](int x, int y) {
    prefetch_below(surface.id, x, y);
    const MF shown = And(FirstLanes(row.x1 - x), HasSurface(surface.id, x, y));
    const VF depth = LoadAndPrefetch(surface.depth, x, y);
    const VF3 normal = LoadAndPrefetch(surface.normal, x, y);
    MF usable = And(shown, IsUsable(depth, normal));
    VF square = Zero();
    for (int c = 0; c < 3; ++c) {
      const VF safe = IfThenElseZero(usable, normal[c]);
      square = Add(square, Mul(safe, safe));
    }
    usable = And(usable, And(Gt(square, Set(0.9f)), Lt(square, Set(1.1f))));
    counts.surface += CountLanes(shown);
    counts.unguided += CountLanes(AndNot(usable, shown));
  });
  return counts;
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(CountGuides);

PixelCounts count_guides(const GBuffer& surface, const Rect& row) {
  const FloatTrapsOff comparisons_meet_nan;
  return HWY_DYNAMIC_DISPATCH(CountGuides)(surface, row);
}

}  // namespace eigenlight
#endif
