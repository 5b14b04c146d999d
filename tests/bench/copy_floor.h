// The time to move the bytes that a stage has to move: what its own time is compared with.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "frame/tiles.h"
#include "temporal/stage_clock.h"

namespace eigenlight {

/// Bytes of each pixel that a stage reads, and that it writes, at least once.
struct Traffic {
  int read = 0;
  int write = 0;
};

/// memcpy over stage tiles, of half of the traffic: so it reads one half and writes the other.
class CopyFloor {
 public:
  CopyFloor(Extent extent, Traffic traffic)
      : grid_(stage_tiles(extent)),
        traffic_(static_cast<std::size_t>(traffic.read + traffic.write)),
        from_(extent.pixels() * traffic_ / 2, std::byte{1}),
        to_(from_.size()) {}

  /// Milliseconds of CPU time.
  [[nodiscard]] double run() {
    StageClock clock;
    for_each_tile(grid_, [&](const Tile& tile) {
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

/// Runs `body`, which returns its milliseconds of CPU time, and the copy by turns, so that both
/// meet the same state of the machine. Counters hold medians, which a busy machine moves least.
template <typename Body>
void measure(benchmark::State& state, Extent extent, Traffic traffic, Body&& body) {
  CopyFloor copy(extent, traffic);
  std::vector<double> cpu, copied;
  for (auto _ : state) {
    copied.push_back(copy.run());
    cpu.push_back(body());
    state.SetIterationTime(cpu.back() * 1e-3);
  }
  const double cpu_ms = median(std::move(cpu)), copy_ms = median(std::move(copied));
  state.counters["bytes"] = static_cast<double>(copy.bytes());
  state.counters["copy_ms"] = copy_ms;
  state.counters["cpu_ms"] = cpu_ms;
  state.counters["ratio"] = cpu_ms / copy_ms;
  state.counters["ns_per_pixel"] = cpu_ms * 1e6 / static_cast<double>(extent.pixels());
}

}  // namespace eigenlight
