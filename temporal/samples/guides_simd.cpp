#include "frame/float_traps.h"
#include "frame/prefetch.h"
#include "temporal/samples/guides.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/samples/guides_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;

PixelCounts CountGuides(const GBuffer& surface, const Rect& row) {
  const F d;
  const hn::RebindToUnsigned<F> du;
  const int lanes = static_cast<int>(hn::Lanes(d)), y = row.y0;
  PixelCounts counts;
  for (int x = row.x0; x < row.x1; x += lanes) {
    prefetch_below(surface.id, x, y);
    prefetch_below(surface.depth, x, y);
    const auto id = hn::LoadU(du, surface.id.row(y) + x);
    const auto inside = hn::FirstN(d, static_cast<std::size_t>(row.x1 - x));
    const auto shown = hn::And(inside, hn::RebindMask(d, hn::Ne(id, hn::Zero(du))));
    // Comparisons with NaN are false.
    const VF depth = hn::LoadU(d, surface.depth.row(y) + x);
    auto usable = hn::And(shown, hn::And(hn::Ge(depth, hn::Set(d, kNearestDepth)),
                                         hn::Le(depth, hn::Set(d, kFarthestDepth))));
    VF square = hn::Zero(d);
    for (const auto& plane : surface.normal) {
      prefetch_below(plane, x, y);
      const VF n = hn::LoadU(d, plane.row(y) + x);
      const auto small = hn::Le(hn::Abs(n), hn::Set(d, kLargestNormal));
      usable = hn::And(usable, small);
      const VF safe = hn::IfThenElseZero(small, n);
      square = hn::Add(square, hn::Mul(safe, safe));
    }
    usable = hn::And(usable,
                     hn::And(hn::Gt(square, hn::Set(d, 0.9f)), hn::Lt(square, hn::Set(d, 1.1f))));
    counts.surface += static_cast<std::int64_t>(hn::CountTrue(d, shown));
    counts.unguided += static_cast<std::int64_t>(hn::CountTrue(d, hn::AndNot(usable, shown)));
  }
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
