// Bad values in each field of a frame: they must be counted, not spread, and be forgotten.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};
constexpr int kFrames = 12, kFault = 6, kRecovery = 4;

struct BadValue {
  std::string_view name;
  float value;
  bool counted;  // in the light: excluded because it is not finite or its square overflows
};
constexpr std::array<BadValue, 8> kValues{{{"NaN", std::numeric_limits<float>::quiet_NaN(), true},
                                           {"+Inf", std::numeric_limits<float>::infinity(), true},
                                           {"-Inf", -std::numeric_limits<float>::infinity(), true},
                                           {"-5", -5.0f, false},
                                           {"1e30", 1e30f, true},
                                           {"9e17", 9e17f, false},
                                           {"1e-30", 1e-30f, false},
                                           {"1e-40", 1e-40f, false}}};

struct Shape {
  std::string_view name;
  int x0, y0, x1, y1;

  [[nodiscard]] bool has(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  [[nodiscard]] std::int64_t pixels() const {
    return static_cast<std::int64_t>(x1 - x0) * (y1 - y0);
  }
};
constexpr std::array<Shape, 4> kShapes{{{"a pixel", 20, 17, 21, 18},
                                        {"a line", 0, 30, 64, 31},
                                        {"a tile", 32, 0, 64, 32},
                                        {"everything", 0, 0, 64, 48}}};

enum class Field { kSignal, kAlbedo, kNormal, kDepth, kMotion };

Plane<float>& plane_of(Frame& frame, Field field) {
  switch (field) {
    case Field::kSignal:
      return frame.lights[0].radiance[1];
    case Field::kAlbedo:
      return frame.surface.albedo[1];
    case Field::kNormal:
      return frame.surface.normal[2];
    case Field::kDepth:
      return frame.surface.depth;
    case Field::kMotion:
      break;
  }
  return frame.motion[0];
}

struct Fault {
  Field field;
  BadValue bad;
  Shape shape;
  bool for_ever;

  [[nodiscard]] bool in(int frame) const { return frame == kFault || (for_ever && frame > kFault); }
  [[nodiscard]] std::string text() const {
    return fmt::format("{} at {}, {}", bad.name, shape.name,
                       for_ever ? "in all later frames" : "once");
  }
};

// The camera is static, but the denoiser is not told, so that it warps.
AnalyticOptions clean_options() {
  AnalyticOptions options{.extent = kExtent, .frames = kFrames};
  options.edit = [](Frame& frame) { frame.is_static = false; };
  return options;
}

AnalyticOptions with_fault(const Fault& fault) {
  AnalyticOptions options = clean_options();
  options.edit = [fault](Frame& frame) {
    frame.is_static = false;
    if (!fault.in(frame.index)) return;
    Plane<float>& plane = plane_of(frame, fault.field);
    for (int y = fault.shape.y0; y < fault.shape.y1; ++y) {
      std::fill(plane.at(fault.shape.x0, y), plane.row(y) + fault.shape.x1, fault.bad.value);
    }
  };
  return options;
}

struct Clean {
  std::vector<Planes<3>> pictures;
  NoiseMaps noise;
};

Clean run_clean(StressLog& log) {
  Clean clean;
  StressRun run(log, clean_options());
  while (const Planes<3>* picture = run.step()) clean.pictures.push_back(copy_of(*picture));
  clean.noise = noise_maps(log, clean_options());
  return clean;
}

// The light without noise, times a factor.
Planes<3> true_light(const StressRun& run, float factor) {
  Planes<3> light = make_planes<3>(kExtent);
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        light[static_cast<std::size_t>(c)](x, y) = factor * run.truth({x, y}, c);
      }
    }
  }
  return light;
}

// Deviation of the bad pixels themselves. After four frames of recovery they have the noise of the
// fourth frame of a clean run. Unusable light leaves the history unchanged; a surface that cannot
// be tracked leaves the frame's own samples.
double deviation_of_bad(const Fault& fault, const StressRun& run, const Clean& clean) {
  const auto bad = [&](int x, int y) { return fault.shape.has(x, y); };
  const Planes<3>& wanted = clean.pictures[static_cast<std::size_t>(run.frame().index)];
  if (fault.in(run.frame().index)) {
    if (fault.field == Field::kSignal && !fault.bad.counted) {
      for (const auto& plane : run.picture()) {
        for (int y = 0; y < plane.height(); ++y) {
          for (int x = 0; x < plane.width(); ++x) {
            if (!std::isfinite(plane(x, y))) return plane(x, y);
          }
        }
      }
      return 0.0;
    }
    // The noise of a frame's own three samples.
    const Planes<3> noise = true_light(run, 0.5f / std::sqrt(3.0f));
    return largest_deviation(run.picture(), wanted, noise, bad);
  }
  const bool recovered = run.frame().index >= kFault + kRecovery;
  return recovered ? largest_deviation(run.picture(), wanted, clean.noise[kRecovery - 1], bad)
                   : 0.0;
}

void check_fault(StressLog& log, const Fault& fault, const Clean& clean) {
  StressRun run(log, with_fault(fault));
  while (run.step()) {
    const auto frame = static_cast<std::size_t>(run.frame().index);
    const bool bad_light = fault.field == Field::kSignal && fault.bad.counted;
    const std::int64_t wanted = bad_light && fault.in(run.frame().index) ? fault.shape.pixels() : 0;
    if (run.report().non_finite_pixels != wanted) {
      log.note(std::numeric_limits<double>::infinity(), "count of " + fault.text());
    }
    // Beside surfaces that cannot be tracked a pixel has only its own samples, no neighbors.
    const bool alone = fault.field == Field::kNormal || fault.field == Field::kDepth;
    const Planes<3> own = true_light(run, 0.5f / std::sqrt(3.0f * static_cast<float>(frame + 1)));
    log.note(
        largest_deviation(run.picture(), clean.pictures[frame], alone ? own : clean.noise[frame],
                          [&](int x, int y) { return !fault.shape.has(x, y); }),
        "the others, " + fault.text());
    log.note(deviation_of_bad(fault, run, clean), "itself, " + fault.text());
  }
}

template <Field kField>
StressFinding check_field(StressLog& log) {
  const Clean clean = run_clean(log);
  for (const BadValue& bad : kValues) {
    // A motion of five pixels is valid.
    if (kField == Field::kMotion && bad.value == -5.0f) continue;
    for (const Shape& shape : kShapes) {
      for (const bool for_ever : {false, true}) {
        // Values with a finite square that many pixels share, or that stay, are light, not a fault.
        const bool is_light = kField == Field::kSignal && !bad.counted && shape.pixels() > 64;
        if (is_light || (bad.value == 9e17f && for_ever)) continue;
        check_fault(log, {kField, bad, shape, for_ever}, clean);
      }
    }
  }
  return worst_of(log, kChance);
}

}  // namespace

std::vector<StressCase> value_cases() {
  return {{"values.signal", "bad light: difference from a clean run / its noise", false,
           check_field<Field::kSignal>},
          {"values.albedo", "bad albedo: difference from a clean run / its noise", false,
           check_field<Field::kAlbedo>},
          {"values.normal", "bad normals: difference from a clean run / its noise", false,
           check_field<Field::kNormal>},
          {"values.depth", "bad depths: difference from a clean run / its noise", false,
           check_field<Field::kDepth>},
          {"values.motion", "bad motion: difference from a clean run / its noise", false,
           check_field<Field::kMotion>}};
}

}  // namespace eigenlight
