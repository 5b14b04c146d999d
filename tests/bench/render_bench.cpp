// Rays a second of indirect light (no guide rays, no direct light), on all threads.
//
// EIGENLIGHT_SHARED names a folder with scenes/crytek-sponza, by default ../shared seen from the
// project; without it only the procedural scene is timed.
#include <benchmark/benchmark.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "frame/random.h"
#include "frame/tiles.h"
#include "render/loading/scene_file.h"
#include "render/paths/gbuffer.h"
#include "render/paths/path_tracer.h"
#include "render/paths/sample_queue.h"
#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{480, 270};
constexpr int kSamples = 3;  // Chen 2012
constexpr int kBounces = 3;

/// A hall of 40,000 small triangles under a sun and a sky.
Scene procedural_scene() {
  Scene scene;
  const int stone = test::add_material(scene, glm::vec3(0.6f));
  test::add_floor(scene, stone, 20.0f);
  for (std::uint32_t i = 0; i < 40000; ++i) {
    const auto unit = [i](std::uint32_t d) { return to_unit(hash_key(i, d)); };
    const glm::vec3 corner(20.0f * unit(0) - 10.0f, 5.0f * unit(1), 20.0f * unit(2) - 10.0f);
    const glm::vec3 u(unit(3) - 0.5f, unit(4) - 0.5f, unit(5) - 0.5f);
    const glm::vec3 v(unit(6) - 0.5f, unit(7) - 0.5f, unit(8) - 0.5f);
    if (i == 0) {
      test::add_quad(scene, stone, {corner, 0.4f * u, 0.4f * v});
      continue;
    }
    Mesh& mesh = scene.meshes.back();
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec3& p : {corner, corner + 0.4f * u, corner + 0.4f * v}) {
      mesh.positions.push_back(p);
      mesh.texcoords.emplace_back(0.0f);
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  scene.lights.suns = {{glm::normalize(glm::vec3(1, 3, 1)), glm::vec3(10.0f), 0.53f}};
  scene.lights.sky = glm::vec3(1.0f);
  scene.camera_path = {{0.0f, {-12, 3, 0}, {0, 2, 0}}};
  return scene;
}

std::filesystem::path sponza_path() {
  const char* shared = std::getenv("EIGENLIGHT_SHARED");
  const std::filesystem::path root = shared != nullptr
                                         ? std::filesystem::path(shared)
                                         : std::filesystem::path(EIGENLIGHT_ROOT) / ".." / "shared";
  return root / "scenes" / "crytek-sponza" / "scene.json";
}

/// The first view of a scene, ready for indirect light.
class IndirectBench {
 public:
  explicit IndirectBench(Scene scene)
      : scene_(std::move(scene)),
        geometry_(scene_),
        surfaces_(scene_, geometry_),
        lights_(scene_, geometry_),
        tracer_({geometry_, surfaces_, lights_}, kBounces),
        grid_(kExtent, 16, 16),
        hits_(kExtent) {
    lights_.update(scene_.lights);
    const CameraKey& key = scene_.camera_path.front();
    Frame frame;
    frame.resize(kExtent);
    frame.camera = look_at(key.eye, key.look_at, scene_.up, scene_.fov_y, kExtent);
    const PreviousView previous{frame.camera, scene_.lights, geometry_.transforms()};
    for_each_tile(grid_, [&](const Tile& tile) {
      trace_guides({geometry_, surfaces_, lights_}, previous, tile, frame, hits_);
    });
  }

  /// One frame's worth of samples. Returns the rays traced, and adds up the light so that it is not
  /// left out.
  [[nodiscard]] std::int64_t run(std::uint32_t frame, double& light) const {
    std::atomic<std::int64_t> rays = 0;
    std::vector<double> sums(static_cast<std::size_t>(grid_.count()));
    for_each_tile(grid_, [&](const Tile& tile) {
      RayCounters tally;
      FiniteMean mean;
      SampleQueue queue(tracer_, tally);
      for (int y = tile.y0; y < tile.y1; ++y) {
        for (int x = tile.x0; x < tile.x1; ++x) {
          if (hits_(x, y).kind != GuideHit::Kind::kSurface) continue;
          for (std::uint32_t i = 0; i < kSamples; ++i) {
            queue.add(hits_(x, y).point, Sampler(hash_key(frame, x, y), i), mean);
          }
        }
      }
      queue.flush();
      if (tally.rays > 0) {
        sums[static_cast<std::size_t>(tile.index)] = static_cast<double>(mean.value().y);
      }
      rays += tally.rays;
    });
    for (const double sum : sums) light += sum;
    return rays;
  }

 private:
  Scene scene_;
  EmbreeScene geometry_;
  SurfaceTable surfaces_;
  LightSet lights_;
  PathTracer tracer_;
  TileGrid grid_;
  Plane<GuideHit> hits_;
};

void measure(benchmark::State& state, const IndirectBench& bench) {
  double light = 0.0;
  if (bench.run(0, light) == 0 || !(light > 0.0)) {
    state.SkipWithError("no light reaches the view");
    return;
  }
  std::int64_t rays = 0;
  std::uint32_t frame = 0;
  for (auto _ : state) rays += bench.run(++frame, light);
  benchmark::DoNotOptimize(light);
  state.counters["rays"] =
      benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
  state.counters["rays_per_sample"] = static_cast<double>(rays) /
                                      static_cast<double>(state.iterations()) /
                                      (static_cast<double>(kExtent.pixels()) * kSamples);
}

void indirect_procedural(benchmark::State& state) {
  static const IndirectBench bench(procedural_scene());
  measure(state, bench);
}
BENCHMARK(indirect_procedural)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void indirect_sponza(benchmark::State& state) {
  if (!std::filesystem::exists(sponza_path())) {
    state.SkipWithError("no crytek-sponza: set EIGENLIGHT_SHARED");
    return;
  }
  std::vector<std::string> notes;
  static const IndirectBench bench(load_scene(sponza_path(), {}, notes));
  measure(state, bench);
}
BENCHMARK(indirect_sponza)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace eigenlight
