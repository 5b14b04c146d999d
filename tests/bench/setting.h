// Arguments of a benchmark, and the frames that they ask for.
#pragma once

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "reproject/basis_field.h"
#include "temporal/stage_clock.h"
#include "tests/bench/room.h"

namespace eigenlight {

inline constexpr int kFloat = 4;  ///< bytes

/// Bytes of a pixel's bases and age.
inline int basis_bytes(int bases) { return (3 * bases + 1) * kFloat; }

/// Instruction sets that this machine and this build have, best first.
[[nodiscard]] inline const std::vector<std::int64_t>& bench_targets() {
  static const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  return targets;
}

/// From height (16:9), bases K, threads, and target (index into bench_targets()), the arguments of
/// all benchmarks of stages. Sets the number of threads, binds Highway to the target and labels the
/// benchmark with its name.
struct Setting {
  explicit Setting(benchmark::State& state)
      : height(static_cast<int>(state.range(0))),
        bases(static_cast<int>(state.range(1))),
        extent{height * 16 / 9, height} {
    set_thread_count(static_cast<int>(state.range(2)));
    const std::int64_t target = bench_targets().at(static_cast<std::size_t>(state.range(3)));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    state.SetLabel(hwy::TargetName(target));
  }
  /// Those of the last size and light are kept.
  [[nodiscard]] const RoomLap& lap(RoomLight light = RoomLight::kChanging) const {
    static std::unique_ptr<RoomLap> lap;
    if (!lap || lap->extent != extent || lap->light != light) {
      lap.reset();
      lap = std::make_unique<RoomLap>(extent, light);
    }
    return *lap;
  }

  int height, bases;
  Extent extent;
};

template <typename Plane>
bool is_finite(const Plane& plane) {
  const auto values = plane.storage();
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

inline bool is_sound(const Planes<3>& planes, Extent extent) {
  return std::all_of(planes.begin(), planes.end(), [&](const Plane<float>& plane) {
    return plane.extent() == extent && is_finite(plane) &&
           *std::max_element(plane.storage().begin(), plane.storage().end()) > 0.0f;
  });
}

/// `body` as measure() wants it: returns milliseconds of CPU time.
template <typename Body>
auto timed(Body body) {
  return [body] {
    StageClock clock;
    body();
    return clock.lap().cpu_ms;
  };
}

}  // namespace eigenlight
