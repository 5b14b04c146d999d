#include "temporal/stage_clock.h"
#include "tests/bench/fma_peak.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/fma_peak_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Two units with a latency of 4 to 5 cycles each want 10 sums that do not wait for each other; 12
// and two constants fit 16 registers.
constexpr int kSums = 12;

// Values tend to 1, so that they neither overflow nor become denormal.
float MultiplyAdds(int rounds) {
  const hn::ScalableTag<float> d;
  const auto keep = hn::Set(d, 0.75f), add = hn::Set(d, 0.25f);
  hn::Vec<decltype(d)> sums[kSums];
  for (int k = 0; k < kSums; ++k) sums[k] = hn::Iota(d, static_cast<float>(k));
  for (int i = 0; i < rounds; ++i) {
    for (int k = 0; k < kSums; ++k) sums[k] = hn::MulAdd(sums[k], keep, add);
  }
  for (int k = 1; k < kSums; ++k) sums[0] = hn::Add(sums[0], sums[k]);
  return hn::GetLane(hn::SumOfLanes(d, sums[0])) /
         static_cast<float>(kSums * static_cast<int>(hn::Lanes(d)));
}

int SumLanes() { return kSums * static_cast<int>(hn::Lanes(hn::ScalableTag<float>())); }

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(MultiplyAdds);
HWY_EXPORT(SumLanes);

double fma_gflops() {
  constexpr int kRounds = 500'000;  // 1 ms for two units at 3 GHz
  StageClock clock;
  const float mean = HWY_DYNAMIC_DISPATCH(MultiplyAdds)(kRounds);
  const double cpu_ms = clock.lap().cpu_ms;
  EL_CHECK(mean > 0.999f && mean < 1.001f, "multiply-adds tend to {}, expected 1", mean);
  const double flops = 2.0 * kRounds * HWY_DYNAMIC_DISPATCH(SumLanes)();
  return flops / (cpu_ms * 1e6);
}

}  // namespace eigenlight
#endif
