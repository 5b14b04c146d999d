// What every method promises, on sequences drawn at random. A failure prints the smallest sequence
// that still fails and the seed that draws it again (RC_PARAMS).
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <limits>

#include "frame/float_traps.h"
#include "temporal/methods.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/random_sequence.h"

namespace eigenlight {
namespace {

const FaultChoice kEveryFault{
    {FaultLayer::kLight, FaultLayer::kMotion, FaultLayer::kNormal, FaultLayer::kDepth,
     FaultLayer::kPreviousDepth, FaultLayer::kAlbedo},
    {FaultKind::kNan, FaultKind::kInf, FaultKind::kNegativeInf, FaultKind::kHuge,
     FaultKind::kDenormal, FaultKind::kNegative, FaultKind::kFar, FaultKind::kZero}};
const FaultChoice kLightThatIsNone{{FaultLayer::kLight},
                                   {FaultKind::kNan, FaultKind::kInf, FaultKind::kNegativeInf}};
const FaultChoice kBadGeometry{
    {FaultLayer::kMotion, FaultLayer::kNormal, FaultLayer::kPreviousDepth},
    {FaultKind::kNan, FaultKind::kInf, FaultKind::kNegativeInf, FaultKind::kFar, FaultKind::kZero}};

// Pictures of a method, one a frame, and where its sequence stands.
class Session {
 public:
  Session(std::string_view method, const Sequence& sequence)
      : denoiser_(make_denoiser(method, {sequence.extent, sequence.bases})),
        source_(source_options(sequence)) {}

  [[nodiscard]] const Planes<3>* step() { return denoiser_->step(source_); }
  [[nodiscard]] const Frame& frame() const { return denoiser_->frame(); }
  [[nodiscard]] const FrameReport& report() const { return denoiser_->report(); }

  // Ends the life of denoiser and source, and goes on at `frame` with others that know their state
  // only.
  void resume(std::string_view method, const Sequence& sequence, int frame) {
    StateWriter state;
    denoiser_->save(state);
    denoiser_ = make_denoiser(method, {sequence.extent, sequence.bases});
    StateReader in({state.bytes().data(), state.bytes().size()});
    denoiser_->load(in);
    in.finish();
    AnalyticOptions rest = source_options(sequence);
    rest.first_frame = frame;
    rest.frames -= frame;
    source_ = AnalyticSource(rest);
  }

 private:
  std::unique_ptr<Denoiser> denoiser_;
  AnalyticSource source_;
};

// Largest magnitude in the picture; NaN if any value is.
float largest(const Planes<3>& planes) {
  float most = 0.0f;
  for (const auto& plane : planes) {
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        if (!(std::abs(plane(x, y)) <= most)) most = std::abs(plane(x, y));
        if (std::isnan(most)) return most;
      }
    }
  }
  return most;
}

bool dark_without_surface(const Planes<3>& out, const Frame& frame) {
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (frame.surface.id(x, y) != 0) continue;
      for (const auto& plane : out) {
        if (plane(x, y) != 0.0f) return false;
      }
    }
  }
  return true;
}

std::int64_t pixels_without_light(const Frame& frame) {
  std::int64_t count = 0;
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      const bool finite =
          std::all_of(frame.lights[0].radiance.begin(), frame.lights[0].radiance.end(),
                      [&](const Plane<float>& plane) { return std::isfinite(plane(x, y)); });
      count += frame.surface.id(x, y) != 0 && !finite ? 1 : 0;
    }
  }
  return count;
}

// Largest output over the largest input so far. Means stay within their inputs. Gains extrapolate,
// and the guided filter is linear in its guides, but nothing runs away: 9 is the light's own range,
// 0.2 to 1.8. The papers of chen2012 and meyer2006 promise no bound: a basis with two usable pixels
// may show any, and a point may be shown in frames that hold 500 times the light it was seen in.
float most_gain(std::string_view method) {
  if (method == "chen2012" || method == "meyer2006") return std::numeric_limits<float>::max();
  for (const char* mean : {"noisy", "mean", "cross-bilateral", "atrous"}) {
    if (method == mean) return 1.0001f;
  }
  return 9.0f;
}

// Largest light of a frame that is a number.
float brightest(const Frame& frame) {
  float most = 0.0f;
  for (const Plane<float>& plane : frame.lights[0].radiance) {
    for (int y = 0; y < plane.height(); ++y) {
      for (int x = 0; x < plane.width(); ++x) {
        if (std::isfinite(plane(x, y))) most = std::max(most, plane(x, y));
      }
    }
  }
  return most;
}

float brightest(const Sequence& sequence) {
  Session session("noisy", sequence);
  float most = 0.0f;
  while (session.step() != nullptr) most = std::max(most, brightest(session.frame()));
  return most;
}

class Property : public testing::TestWithParam<std::string_view> {
 protected:
  // NaN is the subject: comparing it is meant.
  const FloatTrapsOff off_;
};

TEST_P(Property, NothingMakesTheOutputNanOrInf) {
  EXPECT_TRUE(rc::check([&] {
    const auto sequence = *any_sequence(kEveryFault);
    Session session(GetParam(), sequence);
    while (const Planes<3>* out = session.step()) {
      RC_ASSERT(all_finite(*out));
      RC_ASSERT(dark_without_surface(*out, session.frame()));
    }
  }));
}

// Found by the property above, and shrunk.
TEST_P(Property, WhatOnceBrokeItDoesNotAnyMore) {
  const auto with = [](Extent extent, std::vector<Fault> faults) {
    Sequence sequence{.extent = extent, .frames = 4, .spp = 1, .bases = 1};
    sequence.slide_x = sequence.slide_y = -24;
    sequence.faults = std::move(faults);
    return sequence;
  };
  using enum FaultLayer;
  using enum FaultKind;
  for (const Sequence& sequence : {
           // Squares of normals that are none, in the guided filter.
           with({1, 2}, {{0, kNormal, kHuge, 0, 0, 0, 1, 2}}),
           // Their 64th powers, in the a-trous filter and in chen2012's.
           with({1, 2}, {{0, kNormal, kNegative, 1, 0, 0, 1, 1}}),
           with({1, 1}, {{1, kNormal, kNegative, 0, 0, 0, 1, 1}}),
           // A negative depth, for which the a-trous filter's decay grew.
           with({1, 2}, {{2, kNormal, kFar, 0, 0, 1, 1, 1}, {2, kDepth, kNegative, 0, 0, 1, 1, 1}}),
           // Products of two lights that float cannot hold, in chen2012's bases.
           with({4, 4}, {{1, kLight, kHuge, 0, 0, 0, 4, 4}}),
           // Squares of positions that far away, in bmfr's features.
           with({1, 2}, {{3, kLight, kNan, 0, 0, 1, 1, 1}, {3, kDepth, kHuge, 0, 0, 1, 1, 1}}),
       }) {
    Session session(GetParam(), sequence);
    while (const Planes<3>* out = session.step()) EXPECT_TRUE(all_finite(*out)) << sequence;
  }
}

TEST_P(Property, LightThatIsNoneIsCountedAndDoesNotSpread) {
  EXPECT_TRUE(rc::check([&] {
    const auto sequence = *any_sequence(kLightThatIsNone);
    Session session(GetParam(), sequence);
    // One that reads ahead has seen all of the sequence before its first picture.
    float seen = GetParam() == "meyer2006" ? brightest(sequence) : 0.0f;
    while (const Planes<3>* out = session.step()) {
      RC_ASSERT(session.report().non_finite_pixels == pixels_without_light(session.frame()));
      seen = std::max(seen, brightest(session.frame()));
      RC_ASSERT(largest(*out) <= most_gain(GetParam()) * seen);
    }
  }));
}

TEST_P(Property, ThreadsDoNotChangeABit) {
  EXPECT_TRUE(rc::check([&] {
    const auto sequence = *any_sequence(kBadGeometry);
    Session one(GetParam(), sequence), three(GetParam(), sequence);
    for (int i = 0; i < sequence.frames; ++i) {
      set_thread_count(1);
      const Planes<3>* a = one.step();
      set_thread_count(3);
      const Planes<3>* b = three.step();
      RC_ASSERT(a != nullptr && b != nullptr);
      RC_ASSERT(same_bits(*a, *b));
    }
  }));
  set_thread_count(0);
}

TEST_P(Property, ResumingDoesNotChangeABit) {
  EXPECT_TRUE(rc::check([&] {
    const auto sequence = *any_sequence(kEveryFault);
    const int stop = *rc::gen::inRange(0, sequence.frames);
    Session straight(GetParam(), sequence), parts(GetParam(), sequence);
    for (int i = 0; i < sequence.frames; ++i) {
      if (i == stop) parts.resume(GetParam(), sequence, i);
      const Planes<3>* a = straight.step();
      const Planes<3>* b = parts.step();
      RC_ASSERT(a != nullptr && b != nullptr);
      RC_ASSERT(same_bits(*a, *b));
    }
  }));
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for (const Method& method : methods()) names.push_back(method.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Methods, Property, testing::ValuesIn(method_names()),
                         [](const auto& test) {
                           std::string name(test.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace eigenlight
