// What a stage cannot be faster than: moving its bytes, and its additions and multiplications.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "frame/tiles.h"
#include "temporal/stage_clock.h"
#include "tests/bench/fma_peak.h"

namespace eigenlight {

/// What a stage does for each pixel: bytes that it reads, and that it writes, at least once, and
/// floating-point operations that its formulas ask for; 0 where bytes are all that counts.
struct Work {
  int read = 0;
  int write = 0;
  double flops = 0.0;
};

/// memcpy over stage tiles, of half of the traffic: so it reads one half and writes the other.
class CopyFloor {
 public:
  CopyFloor(Extent extent, const Work& work)
      : grid_(stage_tiles(extent)),
        traffic_(static_cast<std::size_t>(work.read + work.write)),
        from_(extent.pixels() * traffic_ / 2, std::byte{1}),
        to_(from_.size()) {}

  /// Milliseconds of CPU time.
  [[nodiscard]] double run() {
    StageClock clock;
    for_each_tile(grid_, [&](const Rect& tile) {
      for (int y = tile.y0; y < tile.y1; ++y) {
        const std::size_t begin = offset(tile.x0, y), end = offset(tile.x1, y);
        std::memcpy(to_.data() + begin, from_.data() + begin, end - begin);
      }
    });
    benchmark::ClobberMemory();
    return clock.lap().cpu_ms;
  }
  [[nodiscard]] std::size_t bytes() const { return 2 * from_.size(); }

 private:
  [[nodiscard]] std::size_t offset(int x, int y) const {
    const auto width = static_cast<std::size_t>(grid_.extent().width);
    return (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * traffic_ / 2;
  }

  TileGrid grid_;
  std::size_t traffic_;
  std::vector<std::byte> from_, to_;
};

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Runs `body`, which returns its milliseconds of CPU time, the copy, and the multiply-adds if
/// `work` has operations, by turns, so that all meet the same state of the machine. Counters hold
/// medians, which a busy machine moves least:
///   cpu_ms, ns_per_pixel, pixels_per_second (of CPU time), bytes, copy_ms, ratio = cpu_ms /
///   copy_ms; with operations flops, peak_gflops, and fma_ratio = cpu_ms / (flops / peak).
template <typename Body>
void measure(benchmark::State& state, Extent extent, const Work& work, Body&& body) {
  CopyFloor copy(extent, work);
  std::vector<double> cpu, copied, peaks;
  for (auto _ : state) {
    copied.push_back(copy.run());
    if (work.flops > 0.0) peaks.push_back(fma_gflops());
    cpu.push_back(body());
    state.SetIterationTime(cpu.back() * 1e-3);
  }
  const double cpu_ms = median(std::move(cpu)), copy_ms = median(std::move(copied));
  const auto pixels = static_cast<double>(extent.pixels());
  state.counters["bytes"] = static_cast<double>(copy.bytes());
  state.counters["copy_ms"] = copy_ms;
  state.counters["cpu_ms"] = cpu_ms;
  state.counters["ratio"] = cpu_ms / copy_ms;
  state.counters["ns_per_pixel"] = cpu_ms * 1e6 / pixels;
  state.counters["pixels_per_second"] = pixels / (cpu_ms * 1e-3);
  if (peaks.empty()) return;
  const double peak = median(std::move(peaks)), flops = work.flops * pixels;
  state.counters["flops"] = flops;
  state.counters["peak_gflops"] = peak;
  state.counters["fma_ratio"] = cpu_ms / (flops / peak * 1e-6);
}

}  // namespace eigenlight
