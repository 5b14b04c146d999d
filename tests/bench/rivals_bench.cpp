// CPU time of a frame of the methods that ours is compared with, without what brings the frames.
//
// Bytes a pixel, with 4 for a float or an id: a frame is light 3, motion 2, depth, previous depth,
// normal 3 and id; of the one before, depth, normal 3 and id. Histories: svgf and bmfr two bases
// with an age, read and written; hems2010 twelve floats for each of 16 past frames, one of them
// written; meyer2006 hands out a picture whose samples (12 words) it read ahead.
#include "temporal/methods.h"
#include "tests/bench/floors.h"
#include "tests/bench/register.h"
#include "tests/bench/room_source.h"

namespace eigenlight {
namespace {

constexpr int kFrameBytes = 16 * kFloat, kPicture = 4 * kFloat;

/// Time of a step of `method` after enough frames for all of its history.
void step_of(benchmark::State& state, std::string_view method, const Work& work) {
  const Setting setting(state);
  RoomSource source(setting.lap());
  const auto denoiser = make_denoiser(method, {setting.extent, setting.bases});
  bool sound = false;
  for (int i = 0; i < 20; ++i) sound = is_sound(*denoiser->step(source), setting.extent);
  if (!sound) return state.SkipWithError("output is not finite");
  benchmark::DoNotOptimize(source.take_cpu_ms());
  measure(state, setting.extent, work, [&] {
    StageClock clock;
    benchmark::DoNotOptimize(denoiser->step(source));
    return clock.lap().cpu_ms - source.take_cpu_ms();
  });
}

void svgf(benchmark::State& state) {
  step_of(state, "svgf", {kFrameBytes + basis_bytes(2), kPicture + basis_bytes(2)});
}
void bmfr(benchmark::State& state) {
  step_of(state, "bmfr", {kFrameBytes + basis_bytes(2), kPicture + basis_bytes(2)});
}
void hems2010(benchmark::State& state) {
  step_of(state, "hems2010", {kFrameBytes + 16 * 12 * kFloat, kPicture + 12 * kFloat});
}

/// A frame's share of reading ahead, analysis and its own picture.
void meyer2006(benchmark::State& state) {
  const Setting setting(state);
  const auto run = [&] {
    // meyer2006 reads until the end.
    RoomSource source(setting.lap(), RoomSource::Laps::kOne);
    const auto denoiser = make_denoiser("meyer2006", {setting.extent, setting.bases});
    StageClock clock;
    bool sound = true;
    int count = 0;
    while (const Planes<3>* out = denoiser->step(source)) {
      sound = sound && is_sound(*out, setting.extent);
      ++count;
    }
    const double cpu_ms = clock.lap().cpu_ms - source.take_cpu_ms();
    return sound && count == RoomLap::kFrames ? cpu_ms / count : -1.0;
  };
  if (run() < 0.0) return state.SkipWithError("output is not finite");
  measure(state, setting.extent, {kFrameBytes + 12 * kFloat, kPicture}, run);
}

void of_two_sizes(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.heights = bench_heights({360, 720}), .bases = {3}});
}

BENCHMARK(svgf)->Apply(of_two_sizes);
BENCHMARK(bmfr)->Apply(of_two_sizes);
BENCHMARK(hems2010)->Apply(of_two_sizes);
BENCHMARK(meyer2006)->Apply(of_two_sizes);

}  // namespace
}  // namespace eigenlight
