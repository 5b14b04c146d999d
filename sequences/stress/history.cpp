// Cuts, repeated frames, wrong motion, and frames of another size.
#include <cmath>
#include <limits>

#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Frame 8 after eight frames with `edit` must equal frame 8 of a fresh denoiser.
StressFinding same_as_fresh(StressLog& log, const std::function<void(Frame&)>& edit) {
  AnalyticOptions fresh{.extent = kExtent, .frames = 1};
  fresh.first_frame = 8;
  StressRun alone(log, fresh);
  const Planes<3> wanted = copy_of(alone.finish());
  AnalyticOptions options{.extent = kExtent, .frames = 9};
  options.edit = edit;
  StressRun run(log, options);
  log.note(different_pixels(run.finish(), wanted));
  return worst_of(log, 0.0);
}

StressFinding check_cut(StressLog& log) {
  return same_as_fresh(log, [](Frame& frame) {
    if (frame.index == 8) frame.previous_index = 99;
  });
}

StressFinding check_repeat(StressLog& log) {
  return same_as_fresh(log, [](Frame& frame) {
    if (frame.index == 7) frame.index = 8;  // twice frame 8, both said to follow frame 7
  });
}

// Error of a run without usable history / error of its input.
StressFinding against_input(StressLog& log, const std::function<void(Frame&)>& edit) {
  AnalyticOptions options{.extent = kExtent, .frames = 12};
  options.edit = edit;
  StressRun noisy(log, options, "noisy"), run(log, options);
  while (noisy.step() && run.step()) log.note(relative_error(run) / relative_error(noisy));
  return worst_of(log, 1.0);
}

StressFinding check_jumps(StressLog& log) {
  return against_input(log, [](Frame& frame) {
    frame.is_static = false;
    for (auto& plane : frame.motion) plane.fill(frame.index % 2 == 0 ? 1e9f : -3e38f);
  });
}

StressFinding check_disoccluded(StressLog& log) {
  return against_input(log, [](Frame& frame) {
    frame.is_static = false;
    frame.previous_depth.fill(-1.0f);
  });
}

StressFinding check_random_motion(StressLog& log) {
  return against_input(log, [](Frame& frame) {
    constexpr float kWild[]{kNan, 1e9f,  -1e30f, std::numeric_limits<float>::infinity(),
                            1e5f, -64.0f};
    frame.is_static = false;
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        for (auto& plane : frame.motion) {
          plane(x, y) =
              kWild[hash_key(5u, static_cast<std::uint32_t>(frame.index),
                             static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)) %
                    6];
        }
      }
    }
  });
}

// Each pixel is an object of its own; the camera slides by whole pixels.
StressFinding check_small_objects(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 24};
  options.slide = {1.0f, 0.0f};
  StressRun plain(log, options);
  options.edit = [](Frame& frame) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        frame.surface.id(x, y) =
            1u + (mix32(static_cast<std::uint32_t>((x + frame.index) * 4096 + y)) >> 1);
      }
    }
  };
  StressRun run(log, options);
  while (plain.step() && run.step()) log.note(relative_error(run) / relative_error(plain));
  return worst_of(log, 1.05);
}

// A frame of another size is an error and changes nothing.
StressFinding check_resolution(StressLog& log) {
  const AnalyticOptions options{.extent = kExtent, .frames = 8};
  StressRun straight(log, options);
  const Planes<3> wanted = copy_of(straight.finish());
  StressRun run(log, options);
  AnalyticSource other({.extent = {65, 48}, .frames = 8});
  while (run.step()) {
    const Planes<3> before = copy_of(run.picture());
    bool refused = false;
    try {
      (void)run.denoiser().step(other);
    } catch (const std::invalid_argument&) {
      refused = true;
    }
    log.note(refused ? different_pixels(run.picture(), before)
                     : std::numeric_limits<double>::infinity());
  }
  log.note(different_pixels(run.picture(), wanted));
  return worst_of(log, 0.0);
}

}  // namespace

std::vector<StressCase> history_cases() {
  return {
      {"history.cut", "frame number jumps: number of values that differ from a fresh start", false,
       check_cut},
      {"history.repeat", "frame number repeats: number of values that differ from a fresh start",
       false, check_repeat},
      {"history.jump", "motion leads far outside: error / error of the input", false, check_jumps},
      {"history.disoccluded", "all pixels new in every frame: error / error of the input", false,
       check_disoccluded},
      {"history.wild-motion", "NaN, Inf and huge motion: error / error of the input", false,
       check_random_motion},
      {"history.small-objects", "objects of one pixel: error / error with one object", false,
       check_small_objects},
      {"history.resolution", "frames of another size in between: number of values that change",
       false, check_resolution}};
}

}  // namespace eigenlight
