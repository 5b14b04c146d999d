// CPU time of the denoiser's stages, each beside a copy of the bytes that it has to move.
//
// No renderer: frames of an analytic room are replayed from memory. Arguments: setting.h (CPU time
// of single stages does not depend on threads). What is printed: floors.h. Bytes a pixel, with P
// the bytes of its bases and age (BasisField), 4 for a float or an id:
//
//   stage        reads                                                        writes
//   reproject    motion 2, depth 1, normal 3, id 1; before: depth 1,          P, variance 1
//                normal 3, id 1, P, variance 1
//   tile_sums    P, light 3, variance 1                                       -
//   predict      P, light 3, variance                                         residual 3,
//                                                                             innovation,
//                                                                             expected, variance
//   innovation   innovation, age, samples, variance                           age, variance
//   update       P, residual 3, correction 3, samples, 2 ages                 P, estimate 3
//   temporal     P, variance, light 3, motion 2, depth 1, G-buffer (normal,   P, variance,
//                depth, id) of this frame 5 and of the one before 5           estimate 3
//   denoiser     the same                                                     the same, age,
//                                                                             G-buffer 5
//
// The room's light changes everywhere in every frame, so that every part has work, but for
// denoiser_steady, the same loop under light that does not change.
#include <benchmark/benchmark.h>

#include <cmath>

#include "reproject/warp.h"
#include "temporal/bases/predict.h"
#include "temporal/bases/update.h"
#include "tests/bench/denoiser_loop.h"
#include "tests/bench/floors.h"
#include "tests/bench/register.h"
#include "tests/bench/setting.h"

namespace eigenlight {
namespace {

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
        learning_rates(extent, setting.bases),
        sums(static_cast<std::size_t>(tiles.count())),
        residual(make_planes<3>(extent)),
        correction(make_planes<3>(extent)),
        estimate(make_planes<3>(extent)),
        variance(extent),
        warped_variance(extent),
        predicted_variance(extent),
        samples(extent),
        innovation(extent),
        expected(extent),
        age(extent),
        new_age(extent) {
    copy_planes(current.lights[0].radiance, residual);
    variance.fill(0.05f);
    samples.fill(1.0f);
    age.fill(8.0f);
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
        const Tile row{{tile.x0, y, tile.x1, y + 1}, tile.index};
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
      accumulate_tile({warped, current.lights[0].radiance, warped_variance}, tile, sum);
    });
  }
  // Again and again it takes the prediction from what is left, which float bears.
  void predict() {
    for_each_tile(tiles, [&](const Tile& tile) {
      predict_tile(warped, coefficients, tile,
                   {residual, innovation, expected, predicted_variance});
    });
  }
  void test_innovation() {
    for_each_tile(tiles, [&](const Tile& tile) {
      innovation_tile({innovation, age, samples}, {}, tile, {new_age, warped_variance});
    });
  }
  void update() {
    for_each_tile(tiles, [&](const Tile& tile) {
      update_tile({coefficients, learning_rates, residual, &correction, samples, age, new_age,
                   history.bases(), 0},
                  tile, {warped, estimate});
    });
  }

  const Frame& current;
  const Frame& before;
  Extent extent;
  TileGrid tiles;
  BasisField history, warped;
  CoefficientField coefficients, learning_rates;
  std::vector<TileSums> sums;
  Planes<3> residual, correction, estimate;
  Plane<float> variance, warped_variance, predicted_variance, samples, innovation, expected, age,
      new_age;
};

bool is_finite(const BasisField& field) {
  const auto [width, height] = field.extent();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int line = 0; line < field.lines(); ++line) {
        if (!std::isfinite(field.at(x, y)[kBlock * line])) return false;
      }
    }
  }
  return true;
}

void reproject(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  const float kept = stages.warped.age(setting.extent.width / 2, setting.extent.height / 2);
  if (!is_finite(stages.warped) || std::abs(kept - 8.0f) > 1e-3f) {
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
  if (!is_finite(stages.expected)) return state.SkipWithError("no prediction");
  measure(state, setting.extent, {basis_bytes(setting.bases) + 4 * kFloat, 6 * kFloat},
          timed([&] { stages.predict(); }));
}

void innovation(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  stages.test_innovation();
  if (!is_finite(stages.new_age)) return state.SkipWithError("ages are not finite");
  measure(state, setting.extent, {4 * kFloat, 2 * kFloat},
          timed([&] { stages.test_innovation(); }));
}

void update(benchmark::State& state) {
  const Setting setting(state);
  Stages stages(setting);
  stages.update();
  if (!is_sound(stages.estimate, setting.extent)) return state.SkipWithError("no estimate");
  const int bytes = basis_bytes(setting.bases);
  measure(state, setting.extent, {bytes + 9 * kFloat, bytes + 3 * kFloat},
          timed([&] { stages.update(); }));
}

// What bases, ages and variances go through, as reports count it.
void temporal(benchmark::State& state) {
  const Setting setting(state);
  Loop loop(setting);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  const int bytes = basis_bytes(setting.bases) + kFloat;
  measure(state, setting.extent, {bytes + 16 * kFloat, bytes + 3 * kFloat}, [&] {
    benchmark::DoNotOptimize(loop.step());
    const FrameReport& report = loop.report();
    double cpu_ms = 0.0;
    for (const Stage stage : {Stage::kWarp, Stage::kProject, Stage::kPredict, Stage::kBound,
                              Stage::kCorrect, Stage::kLearn, Stage::kUpdate}) {
      cpu_ms += report[stage].cpu_ms;
    }
    return cpu_ms;
  });
}

void run_denoiser(benchmark::State& state, RoomLight light) {
  const Setting setting(state);
  Loop loop(setting, light);
  if (!loop.is_sound_at_start()) return state.SkipWithError("output is not finite");
  measure(state, setting.extent, loop_work(setting.bases), [&] {
    benchmark::DoNotOptimize(loop.step());
    return loop.cpu_ms();
  });
}

void denoiser(benchmark::State& state) { run_denoiser(state, RoomLight::kChanging); }

void denoiser_steady(benchmark::State& state) { run_denoiser(state, RoomLight::kSteady); }

// The whole loop with one layer of light and with two, by turns: what a second layer costs, as
// `layers_ratio`.
void two_layers(benchmark::State& state) {
  const Setting setting(state);
  RoomLap lap(setting.extent);
  Loop one(setting, lap);
  RoomLap twice(setting.extent);
  twice.repeat_light(2);
  Loop two(setting, twice);
  if (!one.is_sound_at_start() || !two.is_sound_at_start()) {
    return state.SkipWithError("output is not finite");
  }
  std::vector<double> ratios;
  measure(state, setting.extent, loop_work(setting.bases), [&] {
    benchmark::DoNotOptimize(one.step());
    benchmark::DoNotOptimize(two.step());
    ratios.push_back(two.cpu_ms() / one.cpu_ms());
    return two.cpu_ms();
  });
  state.counters["layers_ratio"] = median(std::move(ratios));
}

void of_three_bases_720(benchmark::internal::Benchmark* bench) {
  add_sweep(bench, {.heights = bench_heights({720}), .bases = {3}});
}

void at_default_bases(benchmark::internal::Benchmark* bench) { add_sweep(bench, {.bases = {5}}); }

BENCHMARK(reproject)->Apply(of_all_bases);
BENCHMARK(tile_sums)->Apply(of_all_bases);
BENCHMARK(predict)->Apply(of_all_bases);
BENCHMARK(innovation)->Apply(of_one_basis);
BENCHMARK(update)->Apply(of_all_bases);
BENCHMARK(temporal)->Apply(of_all_threads);
BENCHMARK(denoiser)->Apply(of_all_threads);
BENCHMARK(denoiser_steady)->Apply(at_default_bases);
BENCHMARK(two_layers)->Apply(of_three_bases_720);

}  // namespace
}  // namespace eigenlight
