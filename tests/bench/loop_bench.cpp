// Where the loop's CPU time goes: its own report of each stage, which adds up to the whole.
#include <map>
#include <string>

#include "tests/bench/denoiser_loop.h"
#include "tests/bench/register.h"

namespace eigenlight {
namespace {

/// Besides measure()'s counters the median of each stage, as `warp_ms`.
void loop_stages(benchmark::State& state) {
  const Setting setting(state);
  Loop loop(setting);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  std::map<std::string, std::vector<double>> stages;
  measure(state, setting.extent, loop_work(setting.bases), [&] {
    benchmark::DoNotOptimize(loop.step());
    for (std::size_t i = 0; i < kStageNames.size(); ++i) {
      const Stage stage = static_cast<Stage>(i);
      if (stage == Stage::kSource || stage == Stage::kResample) continue;
      stages[std::string(kStageNames[i]) + "_ms"].push_back(loop.report()[stage].cpu_ms);
    }
    return loop.cpu_ms();
  });
  for (auto& [name, times] : stages) state.counters[name] = median(std::move(times));
}

void of_three_and_five_bases(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.bases = {3, 5}});
}

BENCHMARK(loop_stages)->Apply(of_three_and_five_bases);

}  // namespace
}  // namespace eigenlight
