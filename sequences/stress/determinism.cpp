// The same bits, however the work is done.
#include <fmt/format.h>

#include <cmath>

#include "frame/instruction_sets.h"
#include "frame/tiles.h"
#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

// Moving camera, changing light, a few bad samples: every stage has work.
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

// Threads and order of the loops, as they were.
struct RestoreLoops {
  ~RestoreLoops() {
    set_thread_count(threads);
    set_loop_order(0);
  }
  int threads = thread_count();
};

Planes<3> last_picture(Lab& lab, const AnalyticOptions& options = busy()) {
  StressRun run(lab, options);
  return copy_of(run.finish());
}

// A wide picture is walked in strips of other widths by more threads.
StressFinding check_threads(Lab& lab) {
  const RestoreLoops restore;
  for (const Extent extent : {Extent{191, 107}, Extent{1400, 70}}) {
    set_thread_count(1);
    const Planes<3> wanted = last_picture(lab, busy(extent));
    for (const int threads : {2, 3, 8}) {
      set_thread_count(threads);
      lab.note(different_pixels(last_picture(lab, busy(extent)), wanted),
               fmt::format("{} threads, {} pixels wide", threads, extent.width));
    }
  }
  return worst_of(lab, 0.0);
}

StressFinding check_order(Lab& lab) {
  const RestoreLoops restore;
  const Planes<3> wanted = last_picture(lab);
  for (const std::uint32_t order : {1u, 2u, 3u}) {
    set_loop_order(order);
    lab.note(different_pixels(last_picture(lab), wanted), fmt::format("order {}", order));
  }
  return worst_of(lab, 0.0);
}

StressFinding check_twice(Lab& lab) {
  const Planes<3> wanted = last_picture(lab);
  lab.note(different_pixels(last_picture(lab), wanted));
  return worst_of(lab, 0.0);
}

StressFinding check_resume(Lab& lab) {
  const Planes<3> wanted = last_picture(lab);
  StressRun first(lab, busy());
  for (int i = 0; i < 4; ++i) (void)first.step();
  StateWriter state;
  first.denoiser().save(state);
  AnalyticOptions rest = busy();
  rest.first_frame = 4;
  rest.frames -= 4;
  StressRun second(lab, rest);
  StateReader in({state.bytes().data(), state.bytes().size()});
  second.denoiser().load(in);
  lab.note(different_pixels(second.finish(), wanted));
  return worst_of(lab, 0.0);
}

StressFinding check_targets(Lab& lab) {
  const Planes<3> wanted = last_picture(lab);
  for_each_instruction_set(
      [&](std::string_view name) { lab.note(largest_relative(last_picture(lab), wanted), name); });
  return worst_of(lab, 1e-5);
}

}  // namespace

std::vector<StressCase> determinism_cases() {
  return {
      {"determinism.threads", "1, 2, 3, 8 threads: values that differ", false, check_threads},
      {"determinism.order", "tiles in other orders: values that differ", false, check_order},
      {"determinism.twice", "twice in one process: values that differ", false, check_twice},
      {"determinism.resume", "checkpoint and resume: values that differ", false, check_resume},
      {"determinism.targets", "every instruction set: relative difference", false, check_targets}};
}

}  // namespace eigenlight
