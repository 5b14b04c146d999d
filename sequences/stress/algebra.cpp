// Degenerate frames and bases.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "sequences/stress/eigen_state.h"
#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};

// Largest |picture - value| over all pixels.
double largest_off(const Planes<3>& picture, float value) {
  double largest = 0.0;
  for (const auto& plane : picture) {
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        const double off = std::abs(static_cast<double>(plane(x, y)) - value);
        if (std::isnan(off)) return off;
        largest = std::max(largest, off);
      }
    }
  }
  return largest;
}

StressFinding check_black(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 20};
  options.gain = [](int) { return 0.0f; };
  StressRun run(log, options);
  while (run.step()) log.note(largest_off(run.picture(), 0.0f));
  return worst_of(log, 0.0);
}

// Constant light: only rounding may change it, by one ulp in each of the filter's four passes and
// in each frame up to the longest age.
StressFinding check_constant(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 100};
  options.noise = options.pattern = 0.0f;
  StressRun run(log, options);
  while (run.step()) log.note(largest_off(run.picture(), 1.0f));
  return worst_of(log, (4 + 64) * 1.2e-7);
}

// The same noisy frame repeated is light with fine structure. Its energy must stay within three
// standard deviations (0.3 % each) of the mean of its 9216 values, because filters weight the
// values differently.
StressFinding check_identical(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 40};
  Frame first;
  options.edit = [&first](Frame& frame) {
    if (frame.index == 0) {
      first.resize(kExtent);
      copy_planes(frame.lights[0].radiance, first.lights[0].radiance);
    }
    copy_planes(first.lights[0].radiance, frame.lights[0].radiance);
  };
  StressRun run(log, options);
  while (run.step()) {
    double shown = 0.0, given = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < kExtent.height; ++y) {
        for (int x = 0; x < kExtent.width; ++x) {
          shown += static_cast<double>(run.picture()[c](x, y));
          given += static_cast<double>(first.lights[0].radiance[c](x, y));
        }
      }
    }
    log.note(std::abs(shown / given - 1.0));
  }
  return worst_of(log, 0.01);
}

// A field of three bases with the steady light and the ages of `history`.
BasisField three_bases(const BasisField& history) {
  BasisField three(kExtent, 3);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      for (int c = 0; c < 3; ++c) three.value(x, y, c, 0) = history.value(x, y, c, 0);
      three.age(x, y) = history.age(x, y);
    }
  }
  return three;
}

// Rewrites the bases of an `eigenlight` history; afterwards three are in use.
void edit_bases(StressRun& run, const std::function<void(BasisField&)>& edit) {
  EigenState state(kExtent, 3);
  state.take(run.denoiser());
  state.field = three_bases(state.field);
  edit(state.field);
  for (const int k : {1, 2}) state.memory.born(k);
  state.give(run.denoiser());
}

// V_k = a_k V_0 + b_k C, where C is V_0 with signs of a checkerboard, nearly orthogonal to V_0.
struct Mix {
  std::string_view name;
  float a1, b1, a2, b2;
};
// cosine = a / sqrt(a^2 + b^2): b = 4.472e-4 a makes it 1 - 1e-7.
constexpr std::array<Mix, 5> kMixes{{{"zero", 0, 0, 0, 0},
                                     {"duplicate", 1, 0, 1, 0},
                                     {"opposite", -1, 0, 1, 0},
                                     {"cosine 1 - 1e-7", 1, 4.472e-4f, 0.5f, 4.472e-4f},
                                     {"tiny", 1e-12f, 0, 0, 1e-18f}}};

AnalyticOptions pulsing() {
  AnalyticOptions options{.extent = kExtent, .frames = 24};
  options.gain = [](int f) {
    return f < 8 ? 1.0f : 1.0f + 0.3f * std::sin(0.7f * static_cast<float>(f - 8));
  };
  return options;
}

// Error of the output / error of the input.
StressFinding check_bases(StressLog& log) {
  constexpr double kInput = 0.25 / 3;  // noise^2 / samples
  for (const Mix& mix : kMixes) {
    StressRun run(log, pulsing());
    while (run.step()) {
      const int frame = run.frame().index;
      log.note(relative_error(run) / kInput, mix.name);
      if (frame != 7) continue;
      edit_bases(run, [&](BasisField& field) {
        for (int y = 0; y < kExtent.height; ++y) {
          for (int x = 0; x < kExtent.width; ++x) {
            const float sign = (x + y) % 2 == 0 ? 1.0f : -1.0f;
            for (int c = 0; c < 3; ++c) {
              const float v = field.value(x, y, c, 0);
              field.value(x, y, c, 1) = (mix.a1 + mix.b1 * sign) * v;
              field.value(x, y, c, 2) = (mix.a2 + mix.b2 * sign) * v;
            }
          }
        }
      });
    }
  }
  return worst_of(log, 1.0);
}

// More bases than the light has modes must not increase the error.
StressFinding check_rank(StressLog& log) {
  double with = 0.0, without = 0.0;
  StressRun eight(log, pulsing(), "eigenlight", 8), one(log, pulsing(), "eigenlight", 1);
  while (one.step() && eight.step()) {
    with += relative_error(eight);
    without += relative_error(one);
  }
  log.note(with / without);
  return worst_of(log, 1.05);
}

// One pixel with a surface in each coefficient tile. The pixel has no neighbors, so the bound is
// kChance standard deviations of the mean of its own samples.
StressFinding check_lone_pixels(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 30};
  const auto alone = [](int x, int y) { return x % 32 == 13 && y % 32 == 7; };
  options.edit = [&](Frame& frame) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        if (alone(x, y)) continue;
        frame.surface.id(x, y) = 0;
        frame.surface.depth(x, y) = std::numeric_limits<float>::infinity();
        for (auto& plane : frame.surface.normal) plane(x, y) = 0.0f;
      }
    }
  };
  StressRun run(log, options);
  while (run.step()) {
    const double sigma = 0.5 / std::sqrt(3.0 * std::min(run.frame().index + 1, 64));
    for (int y = 7; y < kExtent.height; y += 32) {
      for (int x = 13; x < kExtent.width; x += 32) {
        for (int c = 0; c < 3; ++c) {
          const float value = run.picture()[static_cast<std::size_t>(c)](x, y);
          log.note(std::abs(static_cast<double>(value) / run.truth({x, y}, c) - 1.0) / sigma);
        }
      }
    }
  }
  return worst_of(log, kChance);
}

// Error long after ages have saturated / error just after. Chance explains 1 % over 60 frames of
// 3072 pixels.
StressFinding check_saturated(StressLog& log) {
  StressRun run(log, {.extent = kExtent, .frames = 320});
  double early = 0.0, late = 0.0;
  while (run.step()) {
    const int frame = run.frame().index;
    if (frame >= 130 && frame < 190) early += relative_error(run);
    if (frame >= 260) late += relative_error(run);
  }
  log.note(late / early);
  return worst_of(log, 1.1);
}

// Error four frames after a jump of the gain / error of the mean of four frames: a history that
// cannot follow must not make the output worse.
StressFinding after_gain(StressLog& log, float gain) {
  constexpr double kInput = 0.25 / (4 * 3);  // noise^2 / samples
  AnalyticOptions options{.extent = kExtent, .frames = 28};
  options.gain = [gain](int f) { return f >= 12 && f < 20 ? gain : 1.0f; };
  StressRun run(log, options);
  while (run.step()) {
    const int frame = run.frame().index;
    if (frame == 15 && gain > 0.0f) log.note(relative_error(run) / kInput, "4 frames after");
    if (frame == 15 && gain == 0.0f) log.note(1e3 * largest_off(run.picture(), 0.0f), "dark");
    if (frame == 23) log.note(relative_error(run) / kInput, "4 frames after the light is back");
  }
  return worst_of(log, 1.0);
}

StressFinding check_off_and_on(StressLog& log) { return after_gain(log, 0.0f); }
StressFinding check_dimmed(StressLog& log) { return after_gain(log, 1e-6f); }
StressFinding check_flooded(StressLog& log) { return after_gain(log, 1e6f); }

// The unit of radiance must not matter.
StressFinding check_brightness(StressLog& log) {
  AnalyticOptions options{.extent = kExtent, .frames = 16};
  options.slide = {0.4f, 0.2f};
  const auto pulse = pulsing().gain;
  for (const float scale : {1e-6f, 1e-3f, 3.0f, 1e3f, 1e6f}) {
    options.gain = pulse;
    StressRun plain(log, options);
    options.gain = [&](int f) { return scale * pulse(f); };
    StressRun scaled(log, options);
    while (plain.step() && scaled.step()) {
      Planes<3> back = copy_of(scaled.picture());
      for (auto& plane : back) {
        for (float& value : plane.storage()) value /= scale;
      }
      log.note(largest_relative(back, plain.picture()), fmt::format("times {:g}", scale));
    }
  }
  return worst_of(log, 1e-5);
}

}  // namespace

std::vector<StressCase> algebra_cases() {
  return {
      {"algebra.black", "frames without light: largest output value", false, check_black},
      {"algebra.constant", "constant light: largest error; the bound is rounding", false,
       check_constant},
      {"algebra.identical", "the same noisy frame repeated: share of energy lost or gained", false,
       check_identical},
      {"algebra.bases", "zero, equal and nearly parallel bases: error / error of the input", false,
       check_bases},
      {"algebra.rank", "8 bases for light of one mode: error / error with 1 basis", false,
       check_rank},
      {"algebra.lone-pixels",
       "one surface pixel per tile: error / standard deviation of its samples' mean", false,
       check_lone_pixels},
      {"algebra.saturated", "error long after ages saturate / error just after", false,
       check_saturated},
      {"algebra.off-and-on", "light off, then on: error 4 frames later / error of 4 frames' mean",
       false, check_off_and_on},
      {"algebra.dimmed",
       "light times 1e-6, then back: error 4 frames later / error of 4 frames' mean", false,
       check_dimmed},
      {"algebra.flooded",
       "light times 1e6, then back: error 4 frames later / error of 4 frames' mean", false,
       check_flooded},
      {"algebra.brightness", "all light times 1e-6 .. 1e6: relative change of the output", false,
       check_brightness}};
}

}  // namespace eigenlight
