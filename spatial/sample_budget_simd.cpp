#include "spatial/sample_budget_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/sample_budget_simd.cpp"
#include <hwy/foreach_target.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// Age in samples, rounded to the nearest: most ages are whole numbers with a small error from
// warping, which must not cost a sample.
VI AgeSamples(const float* age, int spp) {
  const VF n = LoadU(F(), age);
  // Not fused, so that every instruction set rounds alike.
  const VF product = Mul(IfThenElseZero(Gt(n, Zero()), n), Set(spp));
  return ConvertTo(I(), Min(Add(product, Set(0.5f)), Set(kBudgetBins - 1)));
}

// The first `count` lanes that show a surface.
hn::Mask<I> Shown(const std::uint32_t* id, int count) {
  const I d;
  const U du;
  return And(FirstLanes(count, d), RebindMask(d, Ne(LoadU(du, id), Zero(du))));
}

void CountAges(const std::uint32_t* id, const float* age, int count, int spp, int oldest,
               AgeHistogram& pixels) {
  const I d;
  alignas(64) std::int32_t bins[HWY_MAX_BYTES / sizeof(std::int32_t)];
  for (int i = 0; i < count; i += LaneCount(d)) {
    const auto shown = Shown(id + i, count - i);
    const VI samples = Min(AgeSamples(age + i, spp), Set(d, oldest));
    const auto old = And(shown, Eq(samples, Set(d, oldest)));
    pixels[static_cast<std::size_t>(oldest)] += CountLanes(old, d);
    // Most pixels are old, so that few vectors have others to be counted one by one.
    const auto younger = AndNot(old, shown);
    if (AllFalse(d, younger)) continue;
    Store(IfThenElse(younger, samples, Set(d, -1)), d, bins);
    for (int lane = 0; lane < LaneCount(d); ++lane) {
      if (bins[lane] >= 0) ++pixels[static_cast<std::size_t>(bins[lane])];
    }
  }
}

void FillUp(const std::uint32_t* id, const float* age, int count, int spp, int level, int most,
            std::uint8_t* extra) {
  const I d;
  const hn::Rebind<std::uint8_t, I> bytes;
  for (int i = 0; i < count; i += LaneCount(d)) {
    const VI missing = Sub(Set(d, level), AgeSamples(age + i, spp));
    const VI granted = Min(Max(missing, Zero(d)), Set(d, most));
    const VI shown = IfThenElseZero(Shown(id + i, count - i), granted);
    StoreU(hn::DemoteTo(bytes, shown), bytes, extra + i);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(CountAges);
HWY_EXPORT(FillUp);

void count_ages(const std::uint32_t* id, const float* age, int count, int spp, int oldest,
                AgeHistogram& pixels) {
  HWY_DYNAMIC_DISPATCH(CountAges)(id, age, count, spp, oldest, pixels);
}

void fill_up(const std::uint32_t* id, const float* age, int count, int spp, int level, int most,
             std::uint8_t* extra) {
  HWY_DYNAMIC_DISPATCH(FillUp)(id, age, count, spp, level, most, extra);
}

}  // namespace eigenlight
#endif
