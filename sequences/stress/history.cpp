// Histories that end, jump, or never start.
#include <cmath>
#include <limits>

#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// The picture of frame 8 of a fresh denoiser, and after eight frames with `edit`.
StressFinding same_as_fresh(Lab& lab, const std::function<void(Frame&)>& edit) {
  AnalyticOptions fresh{.extent = kExtent, .frames = 1};
  fresh.first_frame = 8;
  StressRun alone(lab, fresh);
  const Planes<3> wanted = copy_of(alone.finish());
  AnalyticOptions options{.extent = kExtent, .frames = 9};
  options.edit = edit;
  StressRun run(lab, options);
  lab.note(different_pixels(run.finish(), wanted));
  return worst_of(lab, 0.0);
}

StressFinding check_cut(Lab& lab) {
  return same_as_fresh(lab, [](Frame& frame) {
    if (frame.index == 8) frame.previous_index = 99;
  });
}

StressFinding check_repeat(Lab& lab) {
  return same_as_fresh(lab, [](Frame& frame) {
    if (frame.index == 7) frame.index = 8;  // twice frame 8, both said to follow frame 7
  });
}

// Error of a run in which no history can be used, over that of its input.
StressFinding against_input(Lab& lab, const std::function<void(Frame&)>& edit) {
  AnalyticOptions options{.extent = kExtent, .frames = 12};
  options.edit = edit;
  StressRun noisy(lab, options, "noisy"), run(lab, options);
  while (noisy.step() && run.step()) lab.note(relative_error(run) / relative_error(noisy));
  return worst_of(lab, 1.0);
}

StressFinding check_jumps(Lab& lab) {
  return against_input(lab, [](Frame& frame) {
    frame.is_static = false;
    for (auto& plane : frame.motion) plane.fill(frame.index % 2 == 0 ? 1e9f : -3e38f);
  });
}

StressFinding check_disoccluded(Lab& lab) {
  return against_input(lab, [](Frame& frame) {
    frame.is_static = false;
    frame.previous_depth.fill(-1.0f);
  });
}

StressFinding check_random_motion(Lab& lab) {
  return against_input(lab, [](Frame& frame) {
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

// Every pixel an object of its own, under a camera that slides by whole pixels.
StressFinding check_small_objects(Lab& lab) {
  AnalyticOptions options{.extent = kExtent, .frames = 24};
  options.slide = {1.0f, 0.0f};
  StressRun plain(lab, options);
  options.edit = [](Frame& frame) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        frame.surface.id(x, y) =
            1u + (mix32(static_cast<std::uint32_t>((x + frame.index) * 4096 + y)) >> 1);
      }
    }
  };
  StressRun run(lab, options);
  while (plain.step() && run.step()) lab.note(relative_error(run) / relative_error(plain));
  return worst_of(lab, 1.05);
}

// A frame of another size is refused, and leaves no trace.
StressFinding check_resolution(Lab& lab) {
  const AnalyticOptions options{.extent = kExtent, .frames = 8};
  StressRun straight(lab, options);
  const Planes<3> wanted = copy_of(straight.finish());
  StressRun run(lab, options);
  AnalyticSource other({.extent = {65, 48}, .frames = 8});
  while (run.step()) {
    const Planes<3> before = copy_of(run.picture());
    bool refused = false;
    try {
      (void)run.denoiser().step(other);
    } catch (const std::invalid_argument&) {
      refused = true;
    }
    lab.note(refused ? different_pixels(run.picture(), before)
                     : std::numeric_limits<double>::infinity());
  }
  lab.note(different_pixels(run.picture(), wanted));
  return worst_of(lab, 0.0);
}

}  // namespace

std::vector<StressCase> history_cases() {
  return {{"history.cut", "frame number jumps: pixels that differ from a fresh start", false,
           check_cut},
          {"history.repeat", "frame number repeats: pixels that differ from a fresh start", false,
           check_repeat},
          {"history.jump", "motion far outside: error over that of the input", false, check_jumps},
          {"history.disoccluded", "all new in every frame: error over that of the input", false,
           check_disoccluded},
          {"history.wild-motion", "NaN, Inf and huge motion: error over that of the input", false,
           check_random_motion},
          {"history.small-objects",
           "objects of one pixel: error over that of one object, equal within 5 %", false,
           check_small_objects},
          {"history.resolution", "frames of another size between: pixels that change", false,
           check_resolution}};
}

}  // namespace eigenlight
