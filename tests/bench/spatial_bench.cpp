// CPU time of the stages that see one frame alone: as denoise_bench.cpp, whose arguments they
// share.
//
//   stage        reads                                        writes
//   budget       id, age                                      1 byte
//   atrous       color 3, variance 1, normal 3, depth, id     color 3, variance 1
//   soft_atrous  color 3, variance 1, 8 packed guides         color 3, variance 1
//   guided       normal 3, depth, id, signal 3, weight, byte  signal 3
#include <cmath>

#include "spatial/guided_filter.h"
#include "spatial/sample_budget.h"
#include "spatial/soft_atrous.h"
#include "temporal/eigen/eigen_denoiser.h"
#include "tests/bench/filter_work.h"
#include "tests/bench/register.h"
#include "tests/bench/room_source.h"

namespace eigenlight {
namespace {

/// The room's light with young pixels in columns, and room for results.
struct Inputs {
  explicit Inputs(const Setting& setting)
      : frame(setting.lap().frames[1]),
        out(make_planes<3>(setting.extent)),
        variance(setting.extent),
        samples(setting.extent),
        age(setting.extent),
        wanted(setting.extent) {
    samples.fill(1.0f);
    wanted.fill(1);
    for (int y = 0; y < age.height(); ++y) {
      for (int x = 0; x < age.width(); ++x) age(x, y) = x % 16 == 0 ? 0.0f : 8.0f;
    }
  }

  const Frame& frame;
  Planes<3> out;
  Plane<float> variance, samples, age;
  Plane<std::uint8_t> wanted;
};

void budget(benchmark::State& state) {
  const Setting setting(state);
  Inputs inputs(setting);
  SampleBudget budget(setting.extent, {});
  Frame frame;
  RoomSource source(setting.lap());
  if (!source.next(frame) || budget.process(frame, inputs.age, inputs.wanted).samples == 0) {
    return state.SkipWithError("no sample granted");
  }
  measure(state, setting.extent, {2 * kFloat, 1}, timed([&] {
            benchmark::DoNotOptimize(budget.process(frame, inputs.age, inputs.wanted).samples);
          }));
}

void atrous(benchmark::State& state) {
  const Setting setting(state);
  Inputs inputs(setting);
  const AtrousOptions options = EigenOptions{}.atrous;
  Atrous filter(setting.extent, options);
  // No pixel is quiet: everything is filtered, each time the same.
  const auto run = [&] {
    copy_planes(inputs.frame.lights[0].radiance, inputs.out);
    inputs.variance.fill(0.05f);
    StageClock clock;
    benchmark::DoNotOptimize(filter.process(inputs.frame, 0.0f, inputs.out, inputs.variance));
    return clock.lap().cpu_ms;
  };
  benchmark::DoNotOptimize(run());
  if (!is_sound(inputs.out, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent, {9 * kFloat, 4 * kFloat, atrous_flops(options)}, run);
}

void soft_atrous(benchmark::State& state) {
  const Setting setting(state);
  Inputs inputs(setting);
  const SoftAtrousOptions options{.passes = 5, .radius = 1};
  SoftAtrous filter(setting.extent, options);
  Plane<PackedGuide> guides;
  pack_guides(inputs.frame, {}, guides);
  const SoftLayer layers[] = {{&inputs.out, &inputs.variance, 5.0f}};
  const auto run = [&] {
    copy_planes(inputs.frame.lights[0].radiance, inputs.out);
    inputs.variance.fill(0.05f);
    StageClock clock;
    filter.process(guides, layers);
    return clock.lap().cpu_ms;
  };
  benchmark::DoNotOptimize(run());
  if (!is_sound(inputs.out, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent,
          {4 * kFloat + sizeof(PackedGuide), 4 * kFloat, soft_atrous_flops(options)}, run);
}

void guided(benchmark::State& state) {
  const Setting setting(state);
  Inputs inputs(setting);
  GuidedFilter filter(setting.extent, {});
  const auto run = [&] {
    benchmark::DoNotOptimize(filter.process(
        {inputs.frame, inputs.frame.lights[0].radiance, inputs.samples, inputs.wanted},
        inputs.out));
  };
  run();
  if (!is_sound(inputs.out, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent, kGuidedWork, timed(run));
}

BENCHMARK(budget)->Apply(of_one_basis);
BENCHMARK(atrous)->Apply(of_one_basis);
BENCHMARK(soft_atrous)->Apply(of_one_basis);
BENCHMARK(guided)->Apply(of_one_basis);

}  // namespace
}  // namespace eigenlight
