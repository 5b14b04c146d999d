// CPU time of the filters that methods of single frames are made of, each beside a copy of the
// bytes that it has to move: it reads normal 3, depth, id, signal 3, weight, two of them albedo 3,
// and writes 3 floats a pixel. Arguments: height (16:9), and what the filter's cost may depend on.
// One thread, the best instruction set. Counters: floors.h.
#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

#include "spatial/rivals/atrous_filter.h"
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"
#include "tests/bench/floors.h"
#include "tests/bench/register.h"
#include "tests/bench/room.h"

namespace eigenlight {
namespace {

constexpr Work kWithAlbedo{12 * kFloat, 3 * kFloat}, kWithoutAlbedo{9 * kFloat, 3 * kFloat};

/// A frame of the room, made once for each size and kept.
const Frame& room(Extent extent) {
  static std::map<int, RoomLap> laps;
  return laps.try_emplace(extent.height, extent).first->second.frames[0];
}

template <typename Filter, typename Options>
void filter_room(benchmark::State& state, const Options& options, const Work& work) {
  set_thread_count(1);
  const int height = static_cast<int>(state.range(0));
  const Extent extent{height * 16 / 9, height};
  const Frame& frame = room(extent);
  Plane<float> weight(extent);
  weight.fill(1.0f);
  Planes<3> out = make_planes<3>(extent);
  Filter filter(extent, options);
  const auto run = [&] { filter.process({frame, frame.lights[0].radiance, weight}, out); };
  run();
  if (!is_sound(out, extent)) return state.SkipWithError("nothing filtered");
  measure(state, extent, work, timed(run));
}

int argument(const benchmark::State& state, int index) {
  return static_cast<int>(state.range(static_cast<std::size_t>(index)));
}

void cross_bilateral(benchmark::State& state) {
  filter_room<CrossBilateral>(state, CrossBilateralOptions{.radius = argument(state, 1)},
                              kWithAlbedo);
}

void atrous_filter(benchmark::State& state) {
  filter_room<AtrousFilter>(state, AtrousFilterOptions{.passes = argument(state, 1)}, kWithAlbedo);
}

void guided_filter(benchmark::State& state) {
  filter_room<GuidedSpatial>(
      state, GuidedOptions{.radius = argument(state, 2), .guides = Guides{argument(state, 1)}},
      kWithoutAlbedo);
}

void with_arguments(benchmark::internal::Benchmark* bench, const std::vector<std::string>& names,
                    const std::vector<std::vector<std::int64_t>>& values) {
  bench->ArgNames(names)->ArgsProduct(values)->UseManualTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(cross_bilateral)->Apply([](auto* bench) {
  with_arguments(bench, {"height", "radius"}, {bench_heights({360, 720}), {8, 16, 24, 32}});
});
BENCHMARK(atrous_filter)->Apply([](auto* bench) {
  with_arguments(bench, {"height", "passes"}, {bench_heights({360, 720}), {3, 4, 5, 6}});
});
BENCHMARK(guided_filter)->Apply([](auto* bench) {
  with_arguments(bench, {"height", "guides", "radius"},
                 {bench_heights({360, 720}), {1, 3, 4}, {8, 16, 24, 32}});
});

}  // namespace
}  // namespace eigenlight
