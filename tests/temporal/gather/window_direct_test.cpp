// Direct light, whose edges are in no guide.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/temporal/gather/window_runs.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{96, 64};

int edge_at(int frame) { return 20 + 2 * frame; }

// A shadow over the left of a still wall, a tenth as bright, whose edge goes 2 pixels a frame.
AnalyticOptions moving_shadow() {
  AnalyticOptions options{
      .extent = kExtent, .frames = 14, .spp = 4, .noise = 1.0f, .pattern = 0.0f};
  options.noise_kind = NoiseKind::kExponential;
  options.light = [](glm::vec2 at, int frame) {
    return at.x < static_cast<float>(edge_at(frame)) ? 0.1f : 1.0f;
  };
  options.edit = [](Frame& frame) { frame.lights[0].is_direct = true; };
  return options;
}

struct Band {
  double mean = 0.0;    // of the picture over the truth
  double square = 0.0;  // mean squared error
};

// Means over columns of some frames, counted from the edge.
class Bands {
 public:
  explicit Bands(const WindowOptions& options)
      : source_(moving_shadow()), outputs_(run_window(frames_of(moving_shadow()), options)) {}

  [[nodiscard]] Band at(int left, int right) const {
    Band sum;
    double count = 0.0;
    for (int frame = 4; frame < 12; ++frame) {
      const Planes<3>& picture = outputs_[static_cast<std::size_t>(frame)];
      const int x0 = std::max(edge_at(frame) + left, 0);
      const int x1 = std::min(edge_at(frame) + right, kExtent.width);
      for (int y = 0; y < kExtent.height; ++y) {
        for (int x = x0; x < x1; ++x) {
          for (int c = 0; c < 3; ++c) {
            const auto truth = static_cast<double>(source_.truth({x, y}, c, frame));
            const auto value = static_cast<double>(picture[c](x, y));
            sum.mean += value / truth;
            sum.square += (value - truth) * (value - truth);
            count += 1.0;
          }
        }
      }
    }
    return {sum.mean / count, sum.square / count};
  }

 private:
  AnalyticSource source_;
  std::vector<Planes<3>> outputs_;
};

// Columns that the edge has passed in the last four frames, and those that it will pass.
TEST(WindowDenoiserDirect, AShadowLeavesNoGhost) {
  for (const int ahead : {0, 4}) {
    const Bands bands(window(ahead));
    EXPECT_NEAR(bands.at(-10, -2).mean, 1.0, 0.03) << ahead;
    EXPECT_NEAR(bands.at(2, 10).mean, 1.0, 0.03) << ahead;
    // An error of a twentieth of the step.
    EXPECT_LT(bands.at(-10, -2).square, std::pow(0.9 / 20.0, 2.0)) << ahead;
  }
  // Without the test of pilots there is one.
  WindowOptions untested = window(0);
  untested.direct.test.slope = 0.0f;
  EXPECT_GT(Bands(untested).at(-10, -2).mean, 2.0);
}

// The two columns that the edge has just passed are those that a window of 5 pixels sees last: they
// may keep a fifteenth of the step. All else of what it passed is a matter of noise alone.
TEST(WindowDenoiserDirect, OtherFramesLowerTheErrorBesideAMovingEdge) {
  const Bands alone(window(0, 0)), past(window(0)), both(window(4));
  EXPECT_LT(past.at(-2, 0).square, std::pow(0.9 / 15.0, 2.0));
  EXPECT_LT(both.at(-2, 0).square, std::pow(0.9 / 15.0, 2.0));
  EXPECT_LT(past.at(-10, -2).square, 0.5 * alone.at(-10, -2).square);
  EXPECT_LT(both.at(-10, -2).square, 0.25 * alone.at(-10, -2).square);
}

TEST(WindowDenoiserDirect, TakesAsManyPastFramesAsAskedFor) {
  const std::vector<Frame> frames = frames_of(moving_shadow());
  std::vector<Frame> mixed = frames_of(moving_shadow());
  for (std::size_t i = 0; i < 3; ++i) {
    for (auto& plane : mixed[i].lights[0].radiance) plane.fill(0.4f);
  }
  const auto one = run_window(frames, window(0, 2)), two = run_window(mixed, window(0, 2));
  ASSERT_EQ(one.size(), 14u);
  EXPECT_FALSE(same_bits(two[4], one[4]));
  for (std::size_t i = 5; i < 14; ++i) EXPECT_TRUE(same_bits(two[i], one[i])) << i;
}

TEST(WindowDenoiserDirect, GatheringLowersNoise) {
  // Before the filter: one standard deviation of almost no size mixes nothing.
  const auto unfiltered = [](int ahead, int past) {
    WindowOptions options = window(ahead, past);
    options.direct.sigmas = 1e-3f;
    return Bands(options).at(15, 99).square;
  };
  const double alone = unfiltered(0, 0);
  EXPECT_NEAR(alone, 0.25, 0.02);
  EXPECT_LT(unfiltered(0, 4), 0.5 * alone);
  EXPECT_LT(unfiltered(4, 4), 0.35 * alone);
}

// After the filter, of the whole picture. The test of pilots is wider than the default one, which
// prefers edges: it takes frames whose noise is alike, and the filter cannot remove what is left.
TEST(WindowDenoiserDirect, AWideTestLowersTheErrorOfTheFilteredPicture) {
  const auto wide = [](int ahead) {
    WindowOptions options = window(ahead);
    options.direct.test.soft = 30.0f;
    options.direct.test.slope = 0.1f;
    return Bands(options).at(-99, 99).square;
  };
  const double alone = Bands(window(0, 0)).at(-99, 99).square;
  EXPECT_LT(wide(0), 0.6 * alone);
  EXPECT_LT(wide(4), 0.35 * alone);
}

}  // namespace
}  // namespace eigenlight
