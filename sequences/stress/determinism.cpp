// Equal bits for any threads, order, process and instruction set.
#include <fmt/format.h>

#include <cmath>

#include "frame/instruction_sets.h"
#include "frame/tiles.h"
#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

// A moving camera, changing light and a bad sample give work to every stage.
AnalyticOptions busy(Extent extent = {191, 107}) {
  AnalyticOptions options{.extent = extent, .frames = 8};
  options.slide = {0.7f, 0.3f};
  options.light = [](glm::vec2 at, int frame) {
    const float edge = at.x - 20.0f * static_cast<float>(frame);
    return 1.0f + 0.8f * std::tanh(0.2f * edge);
  };
  options.edit = [](Frame& frame) { frame.lights[0].radiance[0](30, 40) = INFINITY; };
  return options;
}

// Restores the number of threads and the order of loops.
struct RestoreLoops {
  ~RestoreLoops() {
    set_thread_count(threads);
    set_loop_order(0);
  }
  int threads = thread_count();
};

Planes<3> last_picture(StressLog& log, const AnalyticOptions& options = busy()) {
  StressRun run(log, options);
  return copy_of(run.finish());
}

// More threads process a wide picture in strips of other widths.
StressFinding check_threads(StressLog& log) {
  const RestoreLoops restore;
  for (const Extent extent : {Extent{191, 107}, Extent{1400, 70}}) {
    set_thread_count(1);
    const Planes<3> wanted = last_picture(log, busy(extent));
    for (const int threads : {2, 3, 8}) {
      set_thread_count(threads);
      log.note(different_pixels(last_picture(log, busy(extent)), wanted),
               fmt::format("{} threads, {} pixels wide", threads, extent.width));
    }
  }
  return worst_of(log, 0.0);
}

StressFinding check_order(StressLog& log) {
  const RestoreLoops restore;
  const Planes<3> wanted = last_picture(log);
  for (const std::uint32_t order : {1u, 2u, 3u}) {
    set_loop_order(order);
    log.note(different_pixels(last_picture(log), wanted), fmt::format("order {}", order));
  }
  return worst_of(log, 0.0);
}

StressFinding check_twice(StressLog& log) {
  const Planes<3> wanted = last_picture(log);
  log.note(different_pixels(last_picture(log), wanted));
  return worst_of(log, 0.0);
}

StressFinding check_resume(StressLog& log) {
  const Planes<3> wanted = last_picture(log);
  StressRun first(log, busy());
  for (int i = 0; i < 4; ++i) (void)first.step();
  StateWriter state;
  first.denoiser().save(state);
  AnalyticOptions rest = busy();
  rest.first_frame = 4;
  rest.frames -= 4;
  StressRun second(log, rest);
  StateReader in({state.bytes().data(), state.bytes().size()});
  second.denoiser().load(in);
  log.note(different_pixels(second.finish(), wanted));
  return worst_of(log, 0.0);
}

StressFinding check_targets(StressLog& log) {
  const Planes<3> wanted = last_picture(log);
  for_each_instruction_set(
      [&](std::string_view name) { log.note(largest_relative(last_picture(log), wanted), name); });
  return worst_of(log, 1e-5);
}

}  // namespace

std::vector<StressCase> determinism_cases() {
  return {
      {"determinism.threads", "1, 2, 3, 8 threads: number of different values", false,
       check_threads},
      {"determinism.order", "tiles in other orders: number of different values", false,
       check_order},
      {"determinism.twice", "two runs in one process: number of different values", false,
       check_twice},
      {"determinism.resume", "resumed run: number of values that differ from an uninterrupted run",
       false, check_resume},
      {"determinism.targets", "each instruction set: relative difference from the default", false,
       check_targets}};
}

}  // namespace eigenlight
