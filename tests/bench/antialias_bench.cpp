// CPU time of a frame and of each way of antialiasing it, on all threads: the atrium from its first
// view, 3 samples of indirect and 8 of direct light.
#include <benchmark/benchmark.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "render/builtin/builtin_scenes.h"
#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{160, 90};

/// The scene, and one frame of it.
struct Atrium {
  explicit Atrium(std::vector<int> frames)
      : scene(make_builtin_scene("atrium")),
        animation(test::still(scene, first_view(scene))),
        source(scene, animation, options(), std::move(frames)) {
    if (!source.next(frame)) throw std::logic_error("no frame");
  }
  static RenderOptions options() {
    RenderOptions o;
    o.extent = kExtent;
    return o;
  }
  static Camera first_view(const Scene& scene) {
    const CameraKey& key = scene.camera_path.front();
    return look_at(key.eye, key.look_at, scene.up, scene.fov_y, kExtent);
  }

  Scene scene;
  test::FunctionAnimation animation;
  LiveSource source;
  Frame frame;
};

void count_rays(benchmark::State& state, std::int64_t rays) {
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
  state.counters["rays_per_pixel"] = static_cast<double>(rays) /
                                     static_cast<double>(state.iterations()) /
                                     static_cast<double>(kExtent.pixels());
}

void antialias(benchmark::State& state, const char* text) {
  static Atrium atrium({0});
  const AntialiasOptions options = parse_antialias(text);
  Planes<3> color;
  std::int64_t rays = 0;
  for (auto _ : state) {
    rays +=
        atrium.source.picture(options, atrium.frame, atrium.frame.lights[0].radiance, color).rays;
  }
  if (!(test::mean(color).x > 0.0)) return state.SkipWithError("the picture is black");
  count_rays(state, rays);
}

/// What they are added to: all frames are of one view, so that each costs the same.
void antialias_none(benchmark::State& state) {
  static Atrium atrium(std::vector<int>(100000, 0));
  std::int64_t rays = 0;
  for (auto _ : state) {
    if (!atrium.source.next(atrium.frame)) return state.SkipWithError("no frame");
    rays += atrium.frame.rays;
  }
  count_rays(state, rays);
}

void settings(benchmark::internal::Benchmark* b) {
  b->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(antialias_none)->Apply(settings);
BENCHMARK_CAPTURE(antialias, lookup, "lookup")->Apply(settings);
BENCHMARK_CAPTURE(antialias, sraa, "sraa")->Apply(settings);
BENCHMARK_CAPTURE(antialias, supersample_16, "supersample:16")->Apply(settings);

}  // namespace
}  // namespace eigenlight
