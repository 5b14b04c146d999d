#include "reproject/taps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/reference/taps.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Count {
  int compared = 0, with_history = 0, without = 0, partial = 0;
};

// Compares the taps of one row with the reference, except where a decision hangs on float noise.
void compare_row(const Frame& current, const PreviousSurface& previous, const Rect& row,
                 const TapSegment& taps, Count& count) {
  const int y = row.y0;
  for (int x = row.x0; x < row.x1; ++x) {
    const reference::Taps twin = reference::taps(current, previous, {}, {x, y});
    if (twin.margin < 1e-5) continue;
    const int i = x - row.x0;
    int used = 0;
    for (int t = 0; t < 4; ++t) {
      // Weights are products of differences of pixel coordinates, over a sum of at least 0.01.
      EXPECT_NEAR(taps.weight[t][i], twin.weight[t], 2e-5) << x << ", " << y << " tap " << t;
      const glm::ivec2 tap = taps.tap(t, i);
      EXPECT_TRUE(taps.weight[t][i] == 0.0f || current.extent().contains(tap.x, tap.y))
          << x << ", " << y << " tap " << t;
      used += twin.weight[t] > 0.0 ? 1 : 0;
    }
    ++count.compared;
    ++(used > 0 ? count.with_history : count.without);
    count.partial += used > 0 && used < 4 ? 1 : 0;
  }
}

EL_KERNEL_TEST(Taps, MatchTheReference) {
  const FloatTrapsOff nan_is_meant;
  const RandomFrameOptions options{.extent = extent};
  const Frame before = make_random_frame(options, 4), current = make_random_frame(options, 5);
  const PreviousSurface previous{before.camera, before.surface};
  const TileGrid rows(extent, kSegment, 1);
  on_every_target([&] {
    PerTile<TapSegment> taps(rows);
    for_each_tile(rows,
                  [&](const Tile& row) { compute_taps(current, previous, {}, row, taps[row]); });
    Count count;
    for (int i = 0; i < rows.count(); ++i) {
      compare_row(current, previous, rows.tile(i), taps[i], count);
    }
    const auto pixels = static_cast<int>(extent.pixels());
    EXPECT_GE(count.compared, pixels * 99 / 100);
    if (pixels < 1000) return;
    // The comparison means little unless every case occurs.
    EXPECT_GT(count.with_history, pixels / 2);
    EXPECT_GT(count.without, pixels / 10);
    EXPECT_GT(count.partial, pixels / 20);
  });
}

// A wall at depth 4 that fills 8 x 6 pixels, seen twice by the same camera.
class TapRules : public ::testing::Test {
 protected:
  TapRules() {
    current_ = make_random_frame({.extent = {8, 6}, .sky = false, .disturbed = false}, 0);
    current_.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, {8, 6});
    set_wall(current_);
    before_ = make_random_frame({.extent = {8, 6}, .sky = false, .disturbed = false}, 0);
    before_.camera = current_.camera;
    set_wall(before_);
    current_.motion[0].fill(0.5f);
    current_.motion[1].fill(0.25f);
  }

  static void set_wall(Frame& frame) {
    frame.surface.id.fill(3);
    frame.surface.depth.fill(4.0f);
    frame.previous_depth.fill(4.0f);
    for (std::size_t c = 0; c < 3; ++c) frame.surface.normal[c].fill(c == 2 ? -1.0f : 0.0f);
  }

  // The four weights of pixel (3, 2), whose taps are (3, 2), (4, 2), (3, 3), (4, 3).
  std::array<float, 4> weights(glm::ivec2 pixel = {3, 2}) {
    TapSegment taps;
    compute_taps(current_, {before_.camera, before_.surface}, options_,
                 {0, pixel.y, 8, pixel.y + 1}, taps);
    const int i = pixel.x;
    return {taps.weight[0][i], taps.weight[1][i], taps.weight[2][i], taps.weight[3][i]};
  }

  static constexpr std::array<float, 4> kNone{0, 0, 0, 0};
  static constexpr std::array<float, 4> kAll{0.375f, 0.375f, 0.125f, 0.125f};
  // Without the second tap, the others share its weight.
  static constexpr std::array<float, 4> kWithoutSecond{0.6f, 0, 0.2f, 0.2f};

  static void expect_near(const std::array<float, 4>& found, const std::array<float, 4>& wanted) {
    for (std::size_t t = 0; t < 4; ++t) EXPECT_NEAR(found[t], wanted[t], 1e-6f) << "tap " << t;
  }

  Frame current_, before_;
  TapOptions options_;
};

TEST_F(TapRules, ValidTapsAreBilinear) { expect_near(weights(), kAll); }

TEST_F(TapRules, TapOnAnotherObjectIsRejected) {
  before_.surface.id(4, 2) = 4;
  expect_near(weights(), kWithoutSecond);
}

TEST_F(TapRules, TapWithAnotherNormalIsRejected) {
  const auto turn = [&](float cosine) {
    before_.surface.normal[0](4, 2) = std::sqrt(1.0f - cosine * cosine);
    before_.surface.normal[2](4, 2) = -cosine;
  };
  turn(0.91f);
  expect_near(weights(), kAll);
  turn(0.89f);
  expect_near(weights(), kWithoutSecond);
  turn(-1.0f);
  expect_near(weights(), kWithoutSecond);
}

TEST_F(TapRules, TapAtAnotherDepthIsRejected) {
  before_.surface.depth(4, 2) = 4.0f * 1.019f;
  expect_near(weights(), kAll);
  before_.surface.depth(4, 2) = 4.0f * 1.021f;
  expect_near(weights(), kWithoutSecond);
  before_.surface.depth(4, 2) = kInf;
  expect_near(weights(), kWithoutSecond);
}

TEST_F(TapRules, DistanceIsMeasuredFromThePlane) {
  // A steep floor: depth changes by much more than the bound between neighbors.
  const glm::vec3 normal = glm::normalize(glm::vec3(0, -1, -0.2f));
  for (Frame* frame : {&current_, &before_}) {
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        for (int c = 0; c < 3; ++c) {
          frame->surface.normal[static_cast<std::size_t>(c)](x, y) = normal[c];
        }
        const glm::vec3 ray = frame->camera.pixel_to_view(glm::vec2(x, y) + 0.5f);
        frame->surface.depth(x, y) =
            -1.0f / glm::dot(normal, glm::transpose(frame->camera.world_to_view) * ray);
      }
    }
  }
  const glm::vec3 ray = before_.camera.pixel_to_view({4.0f, 2.75f});
  current_.previous_depth(3, 2) =
      -1.0f / glm::dot(normal, glm::transpose(before_.camera.world_to_view) * ray);
  ASSERT_GT(std::abs(before_.surface.depth(3, 2) / before_.surface.depth(3, 3) - 1.0f), 0.05f);
  expect_near(weights(), kAll);
}

TEST_F(TapRules, TapOutsideTheImageIsRejected) {
  current_.motion[0](7, 2) = 0.25f;  // taps 7 and 8
  expect_near(weights({7, 2}), {0.75f, 0, 0.25f, 0});
  current_.motion[0](0, 2) = -0.25f;  // taps -1 and 0
  expect_near(weights({0, 2}), {0, 0.75f, 0, 0.25f});
  current_.motion[1](3, 0) = -0.5f;  // rows -1 and 0
  expect_near(weights({3, 0}), {0, 0, 0.5f, 0.5f});
  for (const float far : {-100.0f, 100.0f, -1e30f, 1e30f}) {
    current_.motion[0](3, 2) = far;
    expect_near(weights(), kNone);
  }
}

TEST_F(TapRules, NonFiniteMotionHasNoTaps) {
  for (const float bad : {kNan, kInf, -kInf}) {
    for (std::size_t c = 0; c < 2; ++c) {
      current_.motion[c](3, 2) = bad;
      expect_near(weights(), kNone);
      expect_near(weights({4, 2}), kAll);
      current_.motion[c](3, 2) = c == 0 ? 0.5f : 0.25f;
    }
    current_.previous_depth(3, 2) = bad;
    expect_near(weights(), kNone);
    current_.previous_depth(3, 2) = 4.0f;
  }
  for (const float behind : {0.0f, -4.0f}) {
    current_.previous_depth(3, 2) = behind;
    expect_near(weights(), kNone);
  }
}

TEST_F(TapRules, SkyHasNoTaps) {
  current_.surface.id(3, 2) = 0;
  before_.surface.id.fill(0);
  expect_near(weights(), kNone);
}

TEST_F(TapRules, SingleDistantTapIsRejected) {
  before_.surface.id.fill(9);
  before_.surface.id(4, 3) = 3;
  current_.motion[0](3, 2) = current_.motion[1](3, 2) = 0.05f;  // bilinear weight 0.0025
  expect_near(weights(), kNone);
  current_.motion[0](3, 2) = current_.motion[1](3, 2) = 0.2f;  // 0.04
  expect_near(weights(), {0, 0, 0, 1});
}

TEST(TapOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  const auto refused = [](float plane, float cosine) {
    EXPECT_THROW((TapOptions{plane, cosine}.validate()), std::invalid_argument);
  };
  refused(0.0f, 0.9f);
  refused(1.1f, 0.9f);
  refused(kNan, 0.9f);
  refused(0.02f, 1.0f);
  refused(0.02f, -1.1f);
  refused(0.02f, kNan);
  EXPECT_NO_THROW(TapOptions{}.validate());
}

}  // namespace
}  // namespace eigenlight
