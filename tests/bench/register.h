// The arguments that benchmarks of stages run with.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "tests/bench/setting.h"

namespace eigenlight {

using Arguments = std::vector<std::int64_t>;

/// Heights from the environment, such as EIGENLIGHT_BENCH_HEIGHTS="36 360"; else `usual`.
[[nodiscard]] inline Arguments bench_heights(const Arguments& usual) {
  const char* text = std::getenv("EIGENLIGHT_BENCH_HEIGHTS");
  if (text == nullptr) return usual;
  std::istringstream words(text);
  Arguments heights;
  for (std::int64_t height = 0; words >> height;) heights.push_back(height);
  return heights;
}

/// All combinations of the arguments of Setting.
struct Sweep {
  Arguments heights = bench_heights({360, 720, 1080});
  Arguments bases{1};
  Arguments threads{1};
  Arguments targets{0};  ///< the best
};

inline void add_sweep(benchmark::internal::Benchmark* bench, const Sweep& sweep) {
  bench->ArgNames({"height", "bases", "threads", "target"})
      ->ArgsProduct({sweep.heights, sweep.bases, sweep.threads, sweep.targets})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

/// The targets behind the best one, at one size and K = 5 (1 where no basis is seen).
inline void add_targets(benchmark::internal::Benchmark* bench, std::int64_t bases) {
  Sweep sweep{.heights = bench_heights({720}), .bases = {bases}, .targets = {}};
  for (std::size_t i = 1; i < bench_targets().size(); ++i) {
    sweep.targets.push_back(static_cast<std::int64_t>(i));
  }
  if (!sweep.targets.empty()) add_sweep(bench, sweep);
}

/// Stages that never see a basis.
inline void of_one_basis(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {});
  add_targets(bench, 1);
}
inline void of_all_bases(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.bases = {1, 3, 5, 8}});
  add_targets(bench, 5);
}
/// Those that loop over tiles themselves: CPU time with two threads shows what the second costs.
inline void of_all_threads(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.bases = {1, 3, 5, 8}});
  add_sweep(bench, {.bases = {5}, .threads = {2}});
  add_targets(bench, 5);
}

}  // namespace eigenlight
