// The pyramid filter beside what it competes with, in CPU time, and how close it comes to brute
// force.
//
// time/<filter>: frames of an analytic room, every pixel filtered. Radius of the pyramid as given;
// the a-trous filter has three passes of 5 x 5 taps, the guided filter its default radius of 8.
// quality/...: one frame of a built-in scene at 1 or 16 samples a pixel, filtered by the pyramid
// with trained and with untrained weights and by brute force; PSNR and SSIM of display values
// (metrics.h), peak 1.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>

#include "render/builtin_scenes.h"
#include "render/live_source.h"
#include "sequences/flythrough.h"
#include "sequences/metrics.h"
#include "spatial/atrous.h"
#include "spatial/guided_filter.h"
#include "spatial/pyramid_filter.h"
#include "spatial/training/bilateral.h"
#include "tests/bench/floors.h"
#include "tests/bench/register.h"
#include "tests/bench/room_source.h"
#include "tests/bench/setting.h"

namespace eigenlight {
namespace {

// Signal, weight, normal, depth and id in, signal out.
constexpr Work kWork{9 * kFloat, 3 * kFloat};

const Frame& room_frame(int height) {
  static std::map<int, RoomLap> laps;
  return laps.try_emplace(height, Extent{height * 16 / 9, height}).first->second.frames[1];
}

struct Room720 {
  explicit Room720(const benchmark::State& state)
      : frame(room_frame(static_cast<int>(state.range(0)))),
        weight(frame.extent()),
        out(make_planes<3>(frame.extent())) {
    set_thread_count(1);
    weight.fill(1.0f);
  }
  const Frame& frame;
  Plane<float> weight;
  Planes<3> out;
};

template <typename Body>
void run_timed(benchmark::State& state, const Frame& frame, const Body& body) {
  body();
  measure(state, frame.extent(), kWork, timed(body));
}

void time_pyramid(benchmark::State& state) {
  Room720 room(state);
  PyramidFilter filter(room.frame.extent(), {.blur_radius = static_cast<float>(state.range(1))});
  run_timed(state, room.frame, [&] {
    filter.process({room.frame, room.frame.indirect, room.weight}, room.out);
  });
  if (!(room.out[0](room.frame.extent().width / 2, room.frame.extent().height / 2) > 0.0f)) {
    state.SkipWithError("nothing filtered");
  }
}

void time_guided(benchmark::State& state) {
  Room720 room(state);
  GuidedFilter filter(room.frame.extent(), {.radius = static_cast<int>(state.range(1))});
  Plane<std::uint8_t> wanted(room.frame.extent());
  wanted.fill(1);
  run_timed(state, room.frame, [&] {
    benchmark::DoNotOptimize(
        filter.process({room.frame, room.frame.indirect, room.weight, wanted}, room.out));
  });
}

void time_atrous(benchmark::State& state) {
  Room720 room(state);
  Atrous filter(room.frame.extent(), {.passes = static_cast<int>(state.range(1))});
  Plane<float> variance(room.frame.extent());
  run_timed(state, room.frame, [&] {
    copy_planes(room.frame.indirect, room.out);
    variance.fill(0.05f);
    benchmark::DoNotOptimize(filter.process(room.frame, 0.0f, room.out, variance));
  });
}

/// A noisy frame, and attributes for the edge-stopping function.
struct NoisyFrame {
  NoisyFrame(std::string_view name, Extent extent, int spp)
      : scene(make_builtin_scene(name)), attributes(extent, 4), weight(extent) {
    const auto animation = make_flythrough(scene, Perturbation::kNone, extent);
    LiveSource source(scene, *animation, {.extent = extent, .spp = spp, .direct_spp = 1}, {40});
    if (!source.next(frame)) throw std::logic_error("a source of one frame has none");
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        if (frame.surface.id(x, y) == 0) continue;
        weight(x, y) = 1.0f;
        for (std::size_t c = 0; c < 3; ++c) {
          attributes.at(x, y)[c] = frame.surface.normal[c](x, y);
        }
        attributes.at(x, y)[3] = frame.surface.depth(x, y);
      }
    }
  }
  Scene scene;
  Frame frame;
  Plane<float> attributes, weight;
};

Figures compare(const NoisyFrame& noisy, const Planes<3>& found, const Planes<3>& wanted) {
  const Extent extent = noisy.frame.extent();
  SequenceMetrics metrics({});
  MetricFrame frame{
      0, false, make_planes<3>(extent), make_planes<3>(extent), {}, Plane<std::uint8_t>(extent)};
  copy_planes(found, frame.test);
  copy_planes(wanted, frame.reference);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const bool surface = noisy.weight(x, y) > 0.0f;
      frame.bits(x, y) = static_cast<std::uint8_t>(surface ? kFiniteBit | kSurfaceBit : kFiniteBit);
    }
  }
  return metrics.add(std::move(frame))[PixelSet::kSurface];
}

void quality(benchmark::State& state) {
  const BuiltinScene& scene = builtin_scenes()[static_cast<std::size_t>(state.range(0))];
  const int height = static_cast<int>(state.range(3));
  const Extent extent{height * 16 / 9, height};
  const NoisyFrame noisy(scene.name, extent, static_cast<int>(state.range(2)));
  // As in training.
  const GlobalIlluminationEdge edge{64.0f, 16.0f, static_cast<float>(state.range(1))};
  Planes<3> wanted = make_planes<3>(extent), found = make_planes<3>(extent);
  bilateral_filter(edge, {noisy.attributes, noisy.frame.indirect, noisy.weight}, wanted);
  const auto report = [&](const PyramidTable& table, const std::string& name) {
    PyramidFilter filter(extent, edge, table);
    filter.process({noisy.frame, noisy.frame.indirect, noisy.weight}, found);
    const Figures figures = compare(noisy, found, wanted);
    state.counters[name + "_psnr"] = figures[Metric::kPsnr].value_or(0.0);
    state.counters[name + "_ssim"] = figures[Metric::kSsim].value_or(0.0);
  };
  for (auto _ : state) {
    report(trained_pyramid_table(), "trained");
    report(untrained_pyramid_table(), "untrained");
  }
  state.SetLabel(std::string(scene.name));
}

void as_times(benchmark::internal::Benchmark* bench, const std::string& name,
              const std::vector<std::int64_t>& values) {
  bench->ArgNames({"height", name})
      ->ArgsProduct({bench_heights({360, 720}), values})
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

BENCHMARK(time_pyramid)->Apply([](auto* bench) {
  as_times(bench, "radius", {1, 2, 4, 8, 16, 32, 64});
});
BENCHMARK(time_guided)->Apply([](auto* bench) { as_times(bench, "radius", {8}); });
BENCHMARK(time_atrous)->Apply([](auto* bench) { as_times(bench, "passes", {3, 5}); });
BENCHMARK(quality)
    ->ArgNames({"scene", "radius", "spp", "height"})
    ->ArgsProduct({{0, 1, 2}, {8, 16}, {1, 16}, bench_heights({360})})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eigenlight
