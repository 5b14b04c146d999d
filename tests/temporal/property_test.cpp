// Properties of every method on random sequences. A failure prints the smallest sequence that still
// fails and the seed that draws it again (RC_PARAMS).
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
const FaultChoice kNonFiniteLight{{FaultLayer::kLight},
                                  {FaultKind::kNan, FaultKind::kInf, FaultKind::kNegativeInf}};
const FaultChoice kBadGeometry{
    {FaultLayer::kMotion, FaultLayer::kNormal, FaultLayer::kPreviousDepth},
    {FaultKind::kNan, FaultKind::kInf, FaultKind::kNegativeInf, FaultKind::kFar, FaultKind::kZero}};

// A method that denoises a sequence.
class Session {
 public:
  Session(std::string_view method, const Sequence& sequence)
      : denoiser_(make_denoiser(method, {sequence.extent, sequence.bases})),
        source_(source_options(sequence)) {}

  [[nodiscard]] const Planes<3>* step() { return denoiser_->step(source_); }
  [[nodiscard]] const Frame& frame() const { return denoiser_->frame(); }
  [[nodiscard]] const FrameReport& report() const { return denoiser_->report(); }

  // Replaces denoiser and source by new ones that go on at `frame` from the saved state.
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

// Whether the output of a method is bounded by its input. It is not for chen2012, where a basis of
// two usable pixels may have any value, nor for meyer2006, which extrapolates the light of a point
// to frames that are 500 times as bright.
bool is_bounded(std::string_view method) { return method != "chen2012" && method != "meyer2006"; }

// Bound on the largest output over the largest input so far. Means stay within their inputs. Gains
// extrapolate, and the guided filter is linear in its guides, within the range of the light, which
// is 0.2 to 1.8.
float most_gain(std::string_view method) {
  for (const char* mean : {"noisy", "mean", "cross-bilateral", "atrous"}) {
    if (method == mean) return 1.0001f;
  }
  return 9.0f;
}

// Largest finite light of a frame.
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

class Property : public testing::TestWithParam<std::string_view> {
 protected:
  const FloatTrapsOff off_;  // NaN is the subject of these tests
};

TEST_P(Property, OutputIsAlwaysFinite) {
  EXPECT_TRUE(rc::check([&] {
    const auto sequence = *any_sequence(kEveryFault);
    Session session(GetParam(), sequence);
    while (const Planes<3>* out = session.step()) {
      RC_ASSERT(all_finite(*out));
      RC_ASSERT(dark_without_surface(*out, session.frame()));
    }
  }));
}

// Sequences that once made the output non-finite.
TEST_P(Property, OutputIsFiniteForEarlierFailures) {
  const auto with = [](Extent extent, std::vector<Fault> faults) {
    Sequence sequence{.extent = extent, .frames = 4, .spp = 1, .bases = 1};
    sequence.slide_x = sequence.slide_y = -24;
    sequence.faults = std::move(faults);
    return sequence;
  };
  using enum FaultLayer;
  using enum FaultKind;
  for (const Sequence& sequence : {
           // Invalid normals overflow when squared in the guided filter.
           with({1, 2}, {{0, kNormal, kHuge, 0, 0, 0, 1, 2}}),
           // Their 64th powers overflow in the a-trous filters.
           with({1, 2}, {{0, kNormal, kNegative, 1, 0, 0, 1, 1}}),
           with({1, 1}, {{1, kNormal, kNegative, 0, 0, 0, 1, 1}}),
           // A negative depth makes the weight of the a-trous filter grow.
           with({1, 2}, {{2, kNormal, kFar, 0, 0, 1, 1, 1}, {2, kDepth, kNegative, 0, 0, 1, 1, 1}}),
           // Products of two lights overflow in the bases of chen2012.
           with({4, 4}, {{1, kLight, kHuge, 0, 0, 0, 4, 4}}),
           // Squares of distant positions overflow in the features of bmfr.
           with({1, 2}, {{3, kLight, kNan, 0, 0, 1, 1, 1}, {3, kDepth, kHuge, 0, 0, 1, 1, 1}}),
       }) {
    Session session(GetParam(), sequence);
    while (const Planes<3>* out = session.step()) EXPECT_TRUE(all_finite(*out)) << sequence;
  }
}

TEST_P(Property, NonFiniteLightIsCounted) {
  EXPECT_TRUE(rc::check([&] {
    Session session(GetParam(), *any_sequence(kNonFiniteLight));
    while (session.step() != nullptr) {
      RC_ASSERT(session.report().non_finite_pixels == pixels_without_light(session.frame()));
    }
  }));
}

class BoundedProperty : public Property {};

TEST_P(BoundedProperty, OutputIsBoundedByTheFiniteInput) {
  EXPECT_TRUE(rc::check([&] {
    Session session(GetParam(), *any_sequence(kNonFiniteLight));
    float seen = 0.0f;
    while (const Planes<3>* out = session.step()) {
      seen = std::max(seen, brightest(session.frame()));
      RC_ASSERT(largest(*out) <= most_gain(GetParam()) * seen);
    }
  }));
}

TEST_P(Property, ThreadCountDoesNotChangeTheBits) {
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

TEST_P(Property, ResumingDoesNotChangeTheBits) {
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

std::vector<std::string_view> method_names(bool bounded_only) {
  std::vector<std::string_view> names;
  for (const Method& method : methods()) {
    if (!bounded_only || is_bounded(method.name)) names.push_back(method.name);
  }
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string_view>& test) {
  std::string name(test.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Methods, Property, testing::ValuesIn(method_names(false)), test_name);
INSTANTIATE_TEST_SUITE_P(Methods, BoundedProperty, testing::ValuesIn(method_names(true)),
                         test_name);

}  // namespace
}  // namespace eigenlight
