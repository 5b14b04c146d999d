// How CPU time grows: of the loop with pixels and with bases K, of the guided filter with its
// radius. Arguments and counters as in denoise_bench.cpp; guided_radius has `radius` in place of
// `bases`.
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"
#include "tests/bench/denoiser_loop.h"
#include "tests/bench/filter_work.h"
#include "tests/bench/register.h"

namespace eigenlight {
namespace {

void loop(benchmark::State& state) {
  const Setting setting(state);
  Loop loop(setting);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  measure(state, setting.extent, loop_work(setting.bases), [&] {
    benchmark::DoNotOptimize(loop.step());
    return loop.cpu_ms();
  });
}

// One filter at the radius in the place of bases.
template <typename Filter, typename Options>
void filter_radius(benchmark::State& state, Options options, const Work& work) {
  const Setting setting(state);
  const Frame& frame = setting.lap().frames[1];
  options.radius = static_cast<int>(state.range(1));
  Filter filter(setting.extent, options);
  Plane<float> weight(setting.extent);
  Planes<3> out = make_planes<3>(setting.extent);
  weight.fill(1.0f);
  const auto run = [&] { filter.process({frame, frame.lights[0].radiance, weight}, out); };
  run();
  if (!is_sound(out, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent, work, timed(run));
}

void guided_radius(benchmark::State& state) {
  filter_radius<GuidedSpatial>(state, GuidedOptions{}, kGuidedWork);
}

// Reads albedo where the guided filter does not.
void bilateral_radius(benchmark::State& state) {
  filter_radius<CrossBilateral>(state, CrossBilateralOptions{}, {12 * kFloat, 3 * kFloat});
}

void over_pixels(benchmark::internal::Benchmark* bench) {
  add_sweep(bench,
            {.heights = bench_heights({180, 360, 540, 720, 1080, 1440, 2160}), .bases = {3}});
}
void over_bases(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.heights = bench_heights({720}), .bases = {1, 2, 3, 4, 5, 6, 7, 8}});
}
void over_radii(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.heights = bench_heights({720}), .bases = {1, 2, 4, 6, 8, 12, 16}});
  bench->ArgNames({"height", "radius", "threads", "target"});
}

BENCHMARK(loop)->Name("loop_pixels")->Apply(over_pixels);
BENCHMARK(loop)->Name("loop_bases")->Apply(over_bases);
BENCHMARK(guided_radius)->Apply(over_radii);
BENCHMARK(bilateral_radius)->Apply(over_radii);

}  // namespace
}  // namespace eigenlight
