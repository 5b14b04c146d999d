// CPU time of the denoiser's stages, each beside a copy of the bytes that it has to move.
//
// No renderer: frames of an analytic room are replayed from memory. Arguments: height (16:9), bases
// K, threads (CPU time of single stages does not depend on them). tests/bench/table.py turns the
// JSON output into a table. Bytes a pixel, with P the bytes of its bases and age (BasisField), 4
// for a float or an id:
//
//   stage        reads                                                        writes
//   reproject    motion 2, depth 1, normal 3, id 1; before: depth 1,          P, variance 1
//                normal 3, id 1, P, variance 1
//   tile_sums    P, light 3, variance 1                                       -
//   predict      P, light 3                                                   prediction 3,
//                                                                             residual, flag, age
//   innovation   residual, flag, age, samples, variance                       age, variance
//   update       P, prediction 3, correction 3, light 3, samples, 2 ages      P, estimate 3
//   budget       id, age                                                      1 byte
//   atrous       color 3, variance 1, normal 3, depth, id                     color 3, variance 1
//   guided       normal 3, depth, id, signal 3, weight, 1 byte                signal 3
//   temporal     P, variance, light 3, motion 2, depth 1, G-buffer (normal,   P, variance,
//                depth, id) of this frame 5 and of the one before 5           estimate 3
//   denoiser     the same                                                     the same, age,
//                                                                             G-buffer 5
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <numeric>

#include "reproject/warp.h"
#include "spatial/guided_filter.h"
#include "temporal/eigen_denoiser.h"
#include "temporal/predict.h"
#include "temporal/update.h"
#include "tests/bench/copy_floor.h"
#include "tests/bench/room_source.h"

namespace eigenlight {
namespace {

constexpr int kFloat = 4;

int basis_bytes(int bases) { return BasisField::pixel_floats(bases) * kFloat; }

/// Arguments of a benchmark, and the frames that they ask for. Sets the number of threads.
struct Setting {
  explicit Setting(const benchmark::State& state)
      : height(static_cast<int>(state.range(0))),
        bases(static_cast<int>(state.range(1))),
        extent{height * 16 / 9, height} {
    set_thread_count(static_cast<int>(state.range(2)));
  }
  /// Made once for each size and kept.
  [[nodiscard]] const RoomLap& lap() const {
    static std::map<int, RoomLap> laps;
    return laps.try_emplace(height, extent).first->second;
  }

  int height, bases;
  Extent extent;
};

/// Inputs of single stages, as they are in the middle of a sequence.
struct Stages {
  explicit Stages(const Setting& setting)
      : current(setting.lap().frames[1]),
        before(setting.lap().frames[0]),
        extent(setting.extent),
        tiles(extent, kCoefficientTile, kCoefficientTile),
        history(extent, setting.bases),
        warped(extent, setting.bases),
        coefficients(extent, setting.bases),
        learning(extent, setting.bases),
        sums(static_cast<std::size_t>(tiles.count())),
        extra(extent),
        light(make_planes<3>(extent)),
        prediction(make_planes<3>(extent)),
        correction(make_planes<3>(extent)),
        estimate(make_planes<3>(extent)),
        variance(extent),
        warped_variance(extent),
        samples(extent),
        residual(extent),
        confirmed(extent),
        age(extent),
        new_age(extent) {
    copy_planes(current.indirect, light);
    variance.fill(0.05f);
    samples.fill(1.0f);
    new_age.fill(9.0f);
    for_each_tile(tiles, [&](const Tile& tile) { fill_history(tile); });
    reproject();
    predict();
  }

  // Bases of a smooth light and its changes, eight frames old.
  void fill_history(const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        if (before.surface.id(x, y) == 0) continue;
        for (int k = 0; k < history.bases(); ++k) {
          const float wave = std::sin(0.01f * static_cast<float>((k + 1) * x + k * y));
          for (int c = 0; c < 3; ++c) {
            history.value(x, y, c, k) = k == 0 ? 0.5f + 0.1f * wave : 0.1f * wave;
          }
        }
        history.age(x, y) = 8.0f;
      }
    }
  }

  void reproject() {
    const PreviousSurface previous{before.camera, before.surface};
    for_each_tile(tiles, [&](const Tile& tile) {
      TapSegment taps;
      for (int y = tile.y0; y < tile.y1; ++y) {
        const Tile row{tile.x0, y, tile.x1, y + 1, tile.index};
        compute_taps(current, previous, {}, row, taps);
        warp_bases(history, taps, row, warped);
        warp_plane(variance, taps, row, warped_variance);
      }
    });
  }
  void sum_tiles() {
    for_each_tile(tiles, [&](const Tile& tile) {
      TileSums& sum = sums[static_cast<std::size_t>(tile.index)];
      sum = {};
      accumulate_tile({warped, current, warped_variance}, tile, sum);
    });
  }
  void predict() {
    for_each_tile(tiles, [&](const Tile& tile) {
      predict_tile(warped, coefficients, light, tile, {prediction, residual, confirmed, age});
    });
  }
  void test_innovation() {
    for_each_tile(tiles, [&](const Tile& tile) {
      innovation_tile({residual, confirmed, age, samples}, {}, tile, {new_age, warped_variance});
    });
  }
  void update() {
    for_each_tile(tiles, [&](const Tile& tile) {
      update_tile({coefficients, learning, prediction, correction, light, samples, age, new_age,
                   history.bases(), 0},
                  tile, warped, estimate);
    });
  }

  const Frame& current;
  const Frame& before;
  Extent extent;
  TileGrid tiles;
  BasisField history, warped;
  CoefficientField coefficients, learning;
  std::vector<TileSums> sums;
  Plane<std::uint8_t> extra;
  Planes<3> light, prediction, correction, estimate;
  Plane<float> variance, warped_variance, samples, residual, confirmed, age, new_age;
};

template <typename Plane>
bool is_finite(const Plane& plane) {
  const auto values = plane.storage();
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

bool is_sound(const Planes<3>& planes, Extent extent) {
  return std::all_of(planes.begin(), planes.end(), [&](const Plane<float>& plane) {
    return plane.extent() == extent && is_finite(plane) &&
           *std::max_element(plane.storage().begin(), plane.storage().end()) > 0.0f;
  });
}

template <typename Body>
auto timed(Body body) {
  return [body] {
    StageClock clock;
    body();
    return clock.lap().cpu_ms;
  };
}

void reproject(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  const float kept = stages.warped.age(setting.extent.width / 2, setting.extent.height / 2);
  if (!is_finite(stages.warped.data()) || std::abs(kept - 8.0f) > 1e-3f) {
    return state.SkipWithError("history was lost");
  }
  const int bytes = basis_bytes(setting.bases);
  measure(state, setting.extent, {bytes + 13 * kFloat, bytes + kFloat},
          timed([&] { stages.reproject(); }));
}

void tile_sums(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  stages.sum_tiles();
  const double energy = stages.sums[stages.sums.size() / 2].gram[0];
  if (!(std::isfinite(energy) && energy > 0.0)) return state.SkipWithError("no energy");
  measure(state, setting.extent, {basis_bytes(setting.bases) + 4 * kFloat, 0},
          timed([&] { stages.sum_tiles(); }));
}

void predict(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  if (!is_sound(stages.prediction, setting.extent)) return state.SkipWithError("no prediction");
  measure(state, setting.extent, {basis_bytes(setting.bases) + 3 * kFloat, 6 * kFloat},
          timed([&] { stages.predict(); }));
}

void innovation(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  stages.test_innovation();
  if (!is_finite(stages.new_age)) return state.SkipWithError("ages are not finite");
  measure(state, setting.extent, {5 * kFloat, 2 * kFloat},
          timed([&] { stages.test_innovation(); }));
}

void update(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  stages.update();
  if (!is_sound(stages.estimate, setting.extent)) return state.SkipWithError("no estimate");
  const int bytes = basis_bytes(setting.bases);
  measure(state, setting.extent, {bytes + 12 * kFloat, bytes + 3 * kFloat},
          timed([&] { stages.update(); }));
}

void budget(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  SampleBudget budget(setting.extent, {});
  Frame frame;
  RoomSource source(setting.lap());
  if (!source.next(frame) || budget.process(frame, stages.age, stages.extra).samples == 0) {
    return state.SkipWithError("no sample granted");
  }
  measure(state, setting.extent, {2 * kFloat, 1}, timed([&] {
            benchmark::DoNotOptimize(budget.process(frame, stages.age, stages.extra).samples);
          }));
}

void atrous(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  Atrous filter(setting.extent, {});
  // No pixel is quiet: everything is filtered, each time the same.
  const auto run = [&] {
    copy_planes(stages.light, stages.estimate);
    stages.variance.fill(0.05f);
    StageClock clock;
    benchmark::DoNotOptimize(
        filter.process(stages.current, 0.0f, stages.estimate, stages.variance));
    return clock.lap().cpu_ms;
  };
  benchmark::DoNotOptimize(run());
  if (!is_sound(stages.estimate, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent, {9 * kFloat, 4 * kFloat}, run);
}

void guided(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  GuidedFilter filter(setting.extent, {});
  stages.extra.fill(1);
  const auto run = [&] {
    benchmark::DoNotOptimize(filter.process(
        {stages.current, stages.light, stages.samples, stages.extra}, stages.estimate));
  };
  run();
  if (!is_sound(stages.estimate, setting.extent)) return state.SkipWithError("nothing filtered");
  measure(state, setting.extent, {9 * kFloat + 1, 3 * kFloat}, timed(run));
}

/// The loop as a user runs it, a few frames after its start.
class Loop {
 public:
  explicit Loop(const Setting& setting)
      : source_(setting.lap()), denoiser_({setting.extent, setting.bases}) {
    for (int i = 0; i < 2 * RoomLap::kFrames; ++i) sound_ = is_sound(*step(), setting.extent);
  }
  const Planes<3>* step() {
    StageClock clock;
    const Planes<3>* output = denoiser_.step(source_);
    cpu_ms_ = clock.lap().cpu_ms - source_.take_cpu_ms();
    return output;
  }
  [[nodiscard]] bool is_sound_at_start() const { return sound_; }
  [[nodiscard]] double cpu_ms() const { return cpu_ms_; }
  [[nodiscard]] const FrameReport& report() const { return denoiser_.report(); }

 private:
  RoomSource source_;
  EigenDenoiser denoiser_;
  bool sound_ = false;
  double cpu_ms_ = 0.0;
};

// Reproject, project, update, as reports count them.
void temporal(benchmark::State& state) {
  const Setting setting(state);
  Loop loop(setting);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  const int bytes = basis_bytes(setting.bases) + kFloat;
  measure(state, setting.extent, {bytes + 16 * kFloat, bytes + 3 * kFloat}, [&] {
    benchmark::DoNotOptimize(loop.step());
    const FrameReport& report = loop.report();
    return report[Stage::kReproject].cpu_ms + report[Stage::kProject].cpu_ms +
           report[Stage::kUpdate].cpu_ms;
  });
}

void denoiser(benchmark::State& state) {
  const Setting setting(state);
  Loop loop(setting);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  const int bytes = basis_bytes(setting.bases) + kFloat;
  measure(state, setting.extent, {bytes + 16 * kFloat, bytes + 9 * kFloat}, [&] {
    benchmark::DoNotOptimize(loop.step());
    return loop.cpu_ms();
  });
}

const std::vector<std::int64_t> kHeights{360, 720}, kBases{1, 3, 5, 8};

void with_arguments(benchmark::internal::Benchmark* bench,
                    const std::vector<std::vector<std::int64_t>>& arguments) {
  bench->ArgNames({"height", "bases", "threads"})
      ->ArgsProduct(arguments)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

// Stages that never see a basis.
void of_one_basis(benchmark::internal::Benchmark* bench) {
  with_arguments(bench, {kHeights, {1}, {1}});
}
void of_all_bases(benchmark::internal::Benchmark* bench) {
  with_arguments(bench, {kHeights, kBases, {1}});
}
void of_all_threads(benchmark::internal::Benchmark* bench) {
  with_arguments(bench, {kHeights, kBases, {1, 2}});
}

BENCHMARK(reproject)->Apply(of_all_bases);
BENCHMARK(tile_sums)->Apply(of_all_bases);
BENCHMARK(predict)->Apply(of_all_bases);
BENCHMARK(innovation)->Apply(of_one_basis);
BENCHMARK(update)->Apply(of_all_bases);
BENCHMARK(budget)->Apply(of_one_basis);
BENCHMARK(atrous)->Apply(of_one_basis);
BENCHMARK(guided)->Apply(of_one_basis);
BENCHMARK(temporal)->Apply(of_all_threads);
BENCHMARK(denoiser)->Apply(of_all_threads);

}  // namespace
}  // namespace eigenlight
