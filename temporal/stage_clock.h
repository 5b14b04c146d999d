// Measures wall time and CPU time of a stage.
#pragma once

#include <chrono>
#include <ctime>

#include "temporal/denoiser.h"

namespace eigenlight {

/// Starts when it is constructed. lap() returns the time since then or since the last lap. CPU time
/// is the sum over all threads of the process.
class StageClock {
 public:
  [[nodiscard]] StageTime lap() {
    const auto wall = std::chrono::steady_clock::now();
    const double cpu = cpu_ms();
    const StageTime time{std::chrono::duration<double, std::milli>(wall - wall_).count(),
                         cpu - cpu_};
    wall_ = wall;
    cpu_ = cpu;
    return time;
  }

 private:
  [[nodiscard]] static double cpu_ms() {
    timespec now = {};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
  }

  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = cpu_ms();
};

}  // namespace eigenlight
