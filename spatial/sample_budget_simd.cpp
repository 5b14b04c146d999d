#include "spatial/sample_budget_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/sample_budget_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;

// Age in whole samples, to the nearest: most ages are whole numbers but for the rounding of their
// warp, and must not lose a sample to it.
hn::Vec<I> AgeSamples(const float* age, int spp) {
  const F d;
  const auto n = hn::LoadU(d, age);
  // Not fused, so that every instruction set rounds alike.
  const auto product =
      hn::Mul(hn::IfThenElseZero(hn::Gt(n, hn::Zero(d)), n), hn::Set(d, static_cast<float>(spp)));
  const auto samples = hn::Add(product, hn::Set(d, 0.5f));
  return hn::ConvertTo(I(), hn::Min(samples, hn::Set(d, static_cast<float>(kBudgetBins - 1))));
}

// The first `count` lanes that show a surface.
hn::Mask<I> Shown(const std::uint32_t* id, int count) {
  const I d;
  const U du;
  const auto shown = hn::RebindMask(d, hn::Ne(hn::LoadU(du, id), hn::Zero(du)));
  return hn::And(hn::FirstN(d, static_cast<std::size_t>(count)), shown);
}

void CountAges(const std::uint32_t* id, const float* age, int count, int spp, int oldest,
               AgeHistogram& pixels) {
  const I d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  alignas(64) std::int32_t bins[HWY_MAX_BYTES / sizeof(std::int32_t)];
  for (int i = 0; i < count; i += lanes) {
    const auto shown = Shown(id + i, count - i);
    const auto samples = hn::Min(AgeSamples(age + i, spp), hn::Set(d, oldest));
    const auto old = hn::And(shown, hn::Eq(samples, hn::Set(d, oldest)));
    pixels[static_cast<std::size_t>(oldest)] += static_cast<std::int64_t>(hn::CountTrue(d, old));
    // Most pixels are old, so that few vectors have others to be counted one by one.
    if (hn::AllFalse(d, hn::AndNot(old, shown))) continue;
    hn::Store(hn::IfThenElse(hn::AndNot(old, shown), samples, hn::Set(d, -1)), d, bins);
    for (int lane = 0; lane < lanes; ++lane) {
      if (bins[lane] >= 0) ++pixels[static_cast<std::size_t>(bins[lane])];
    }
  }
}

void FillUp(const std::uint32_t* id, const float* age, int count, int spp, int level, int most,
            std::uint8_t* extra) {
  const I d;
  const hn::Rebind<std::uint8_t, I> bytes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < count; i += lanes) {
    const auto missing = hn::Sub(hn::Set(d, level), AgeSamples(age + i, spp));
    const auto granted = hn::Min(hn::Max(missing, hn::Zero(d)), hn::Set(d, most));
    const auto shown = Shown(id + i, count - i);
    hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElseZero(shown, granted)), bytes, extra + i);
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
