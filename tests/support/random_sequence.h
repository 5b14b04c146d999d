// Sequences drawn at random for property tests: size, camera, light, noise, cuts, and faults in any
// layer of any frame. RapidCheck shrinks what fails to the smallest such sequence.
#pragma once

#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <string_view>
#include <vector>

#include "tests/support/analytic_source.h"

namespace eigenlight {

/// What a fault puts into its pixels.
enum class FaultKind {
  kNan,
  kInf,
  kNegativeInf,
  kHuge,      // 1e30: finite, but float cannot square it
  kDenormal,  // 1e-40
  kNegative,  // -3
  kFar,       // 1e9
  kZero
};
inline constexpr std::array<std::string_view, 8> kFaultNames{"NaN",   "Inf", "-Inf", "1e30",
                                                             "1e-40", "-3",  "1e9",  "0"};

/// The layer that a fault changes: light, or one that tells how to treat light.
enum class FaultLayer { kLight, kMotion, kNormal, kDepth, kPreviousDepth, kAlbedo };
inline constexpr std::array<std::string_view, 6> kLayerNames{"light", "motion",         "normal",
                                                             "depth", "previous depth", "albedo"};

/// One value in one channel of a rectangle of pixels of one frame.
struct Fault {
  int frame = 0;
  FaultLayer layer = FaultLayer::kLight;
  FaultKind kind = FaultKind::kNan;
  int channel = 0;
  int x = 0, y = 0, width = 1, height = 1;
};

struct Sequence {
  Extent extent{8, 8};
  int frames = 4, spp = 3, bases = 3, sky_columns = 0;
  std::uint32_t seed = 0;
  int slide_x = 0, slide_y = 0;  ///< eighths of a pixel per frame
  int noise = 0;                 ///< percent of the light
  std::vector<int> gains = {};   ///< light of frame i in percent; 100 beyond the list
  std::vector<int> cuts = {};    ///< frames whose motion leads elsewhere
  std::vector<Fault> faults = {};
};

[[nodiscard]] inline float value_of(FaultKind kind) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr std::array<float, 8> kValues{std::numeric_limits<float>::quiet_NaN(),
                                         kInfinity,
                                         -kInfinity,
                                         1e30f,
                                         1e-40f,
                                         -3.0f,
                                         1e9f,
                                         0};
  return kValues[static_cast<std::size_t>(kind)];
}

inline void apply(const Fault& fault, Frame& frame) {
  if (fault.frame != frame.index) return;
  const auto c = static_cast<std::size_t>(fault.channel);
  Plane<float>* const planes[] = {&frame.lights[0].radiance[c], &frame.motion[c % 2],
                                  &frame.surface.normal[c],     &frame.surface.depth,
                                  &frame.previous_depth,        &frame.surface.albedo[c]};
  Plane<float>& plane = *planes[static_cast<std::size_t>(fault.layer)];
  for (int y = fault.y; y < std::min(fault.y + fault.height, plane.height()); ++y) {
    for (int x = fault.x; x < std::min(fault.x + fault.width, plane.width()); ++x) {
      plane(x, y) = value_of(fault.kind);
    }
  }
}

[[nodiscard]] inline AnalyticOptions source_options(const Sequence& s) {
  AnalyticOptions options{.extent = s.extent, .frames = s.frames};
  options.spp = s.spp;
  options.noise = 0.01f * static_cast<float>(s.noise);
  options.slide = 0.125f * glm::vec2(s.slide_x, s.slide_y);
  options.seed = s.seed;
  options.sky_columns = std::min(s.sky_columns, s.extent.width);
  options.gain = [gains = s.gains](int frame) {
    const auto i = static_cast<std::size_t>(frame);
    return i < gains.size() ? 0.01f * static_cast<float>(gains[i]) : 1.0f;
  };
  options.edit = [faults = s.faults, cuts = s.cuts](Frame& frame) {
    for (const int cut : cuts) frame.previous_index -= cut == frame.index ? 1 : 0;
    for (const Fault& fault : faults) apply(fault, frame);
  };
  return options;
}

inline std::ostream& operator<<(std::ostream& out, const Fault& f) {
  return out << kLayerNames[static_cast<std::size_t>(f.layer)] << ' ' << f.channel << " = "
             << kFaultNames[static_cast<std::size_t>(f.kind)] << " at (" << f.x << ", " << f.y
             << ") size " << f.width << 'x' << f.height << " in frame " << f.frame;
}

inline std::ostream& operator<<(std::ostream& out, const Sequence& s) {
  out << s.extent.width << 'x' << s.extent.height << ", " << s.frames << " frames, " << s.spp
      << " spp, " << s.bases << " bases, sky " << s.sky_columns << ", seed " << s.seed << ", slide "
      << s.slide_x << ' ' << s.slide_y << ", noise " << s.noise << ", gains";
  for (const int gain : s.gains) out << ' ' << gain;
  out << ", cuts";
  for (const int cut : s.cuts) out << ' ' << cut;
  for (const Fault& fault : s.faults) out << "; " << fault;
  return out;
}

/// Kinds and layers that a property is about.
struct FaultChoice {
  std::vector<FaultLayer> layers;
  std::vector<FaultKind> kinds;
};

[[nodiscard]] inline rc::Gen<Fault> any_fault(const FaultChoice& choice) {
  return rc::gen::build<Fault>(rc::gen::set(&Fault::frame, rc::gen::inRange(0, 8)),
                               rc::gen::set(&Fault::layer, rc::gen::elementOf(choice.layers)),
                               rc::gen::set(&Fault::kind, rc::gen::elementOf(choice.kinds)),
                               rc::gen::set(&Fault::channel, rc::gen::inRange(0, 3)),
                               rc::gen::set(&Fault::x, rc::gen::inRange(0, 70)),
                               rc::gen::set(&Fault::y, rc::gen::inRange(0, 34)),
                               rc::gen::set(&Fault::width, rc::gen::inRange(1, 40)),
                               rc::gen::set(&Fault::height, rc::gen::inRange(1, 20)));
}

/// Sizes near those of vectors (up to 16), coefficient tiles (32) and stage tiles (64 x 16).
[[nodiscard]] inline rc::Gen<Extent> any_extent() {
  return rc::gen::build<Extent>(rc::gen::set(&Extent::width, rc::gen::inRange(1, 70)),
                                rc::gen::set(&Extent::height, rc::gen::inRange(1, 36)));
}

[[nodiscard]] inline rc::Gen<Sequence> any_sequence(const FaultChoice& choice) {
  namespace gen = rc::gen;
  return gen::build<Sequence>(
      gen::set(&Sequence::extent, any_extent()), gen::set(&Sequence::frames, gen::inRange(2, 9)),
      gen::set(&Sequence::spp, gen::inRange(1, 9)), gen::set(&Sequence::bases, gen::inRange(1, 9)),
      gen::set(&Sequence::sky_columns, gen::inRange(0, 40)),
      gen::set(&Sequence::seed, gen::arbitrary<std::uint32_t>()),
      gen::set(&Sequence::slide_x, gen::inRange(-24, 25)),
      gen::set(&Sequence::slide_y, gen::inRange(-24, 25)),
      gen::set(&Sequence::noise, gen::inRange(0, 58)),
      gen::set(&Sequence::gains, gen::container<std::vector<int>>(gen::element(0, 1, 100, 500))),
      gen::set(&Sequence::cuts, gen::container<std::vector<int>>(gen::inRange(1, 8))),
      gen::set(&Sequence::faults, gen::container<std::vector<Fault>>(any_fault(choice))));
}

}  // namespace eigenlight
