#include "spatial/packed_guides.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/random.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Guide {
  float normal[3] = {0.0f, 0.0f, -1.0f}, color[3] = {0.5f, 0.5f, 0.5f}, depth = 4.0f;
  std::uint32_t id = 1;
};

PackedGuide pack(const Guide& guide, const GuideWidths& widths = {}) {
  FrameInput frame;
  frame.resize_input({1, 1});
  for (int c = 0; c < 3; ++c) {
    frame.surface.normal[c](0, 0) = guide.normal[c];
    frame.surface.albedo[c](0, 0) = guide.color[c];
  }
  frame.surface.depth(0, 0) = guide.depth;
  frame.surface.id(0, 0) = guide.id;
  Plane<PackedGuide> out;
  pack_guides(frame, widths, out);
  return out(0, 0);
}

// Guides within reach of each other.
Guide random_guide(int key) {
  const auto unit = [&](std::uint32_t d) { return to_unit(hash_key(d, key)); };
  Guide guide;
  for (std::uint32_t c = 0; c < 3; ++c) {
    guide.normal[c] = 2.0f * unit(c) - 1.0f;
    guide.color[c] = unit(3 + c);
  }
  guide.depth = std::exp(unit(6));
  return guide;
}

double square_apart(const Guide& a, const Guide& b, const GuideWidths& widths) {
  double sum = std::pow(std::log(static_cast<double>(a.depth) / static_cast<double>(b.depth)) /
                            static_cast<double>(widths.depth),
                        2.0);
  for (std::size_t c = 0; c < 3; ++c) {
    sum += std::pow(static_cast<double>((a.normal[c] - b.normal[c]) / widths.normal), 2.0);
    sum += std::pow(static_cast<double>((a.color[c] - b.color[c]) / widths.color), 2.0);
  }
  return sum;
}

// Half a step, and rounding of floats.
constexpr float kHalfStep = 0.501f / kGuideSteps;

TEST(PackedGuides, HoldValuesToHalfAStep) {
  const GuideWidths widths{.normal = 0.7f, .color = 0.3f, .depth = 0.4f};
  for (int i = 0; i < 200; ++i) {
    const Guide guide = random_guide(i);
    const PackedGuide packed = pack(guide, widths);
    EXPECT_TRUE(shows_surface(packed));
    for (std::size_t c = 0; c < 3; ++c) {
      const auto value = [&](std::size_t at) {
        return static_cast<float>(packed.normal_color[at]) / kGuideSteps;
      };
      EXPECT_NEAR(value(c), guide.normal[c] / widths.normal, kHalfStep);
      EXPECT_NEAR(value(3 + c), guide.color[c] / widths.color, kHalfStep);
    }
    EXPECT_NEAR(static_cast<float>(packed.depth) / kGuideSteps,
                std::log(guide.depth) / widths.depth, kHalfStep);
  }
}

TEST(PackedGuides, HoldDepthsOfAllScales) {
  for (const float depth : {1e-9f, 1e-3f, 1.0f, 1e4f, 1e9f}) {
    EXPECT_NEAR(static_cast<float>(pack({.depth = depth}).depth) / kGuideSteps,
                std::log(depth) / 0.5f, kHalfStep);
  }
}

TEST(PackedGuides, ColorsAndNormalsAreBounded) {
  const PackedGuide packed = pack({.normal = {7.0f, -7.0f, 0.0f}, .color = {50.0f, -1.0f, 1.0f}});
  EXPECT_EQ(packed.normal_color[0], 2 * 256);
  EXPECT_EQ(packed.normal_color[1], -2 * 256);
  EXPECT_EQ(packed.normal_color[3], 4 * 256);
  EXPECT_EQ(packed.normal_color[4], 0);
  EXPECT_EQ(packed.normal_color[5], 2 * 256);
}

TEST(PackedGuides, WhatIsNotFiniteIsZero) {
  for (const float bad : {kNan, kInf, -kInf}) {
    const PackedGuide packed = pack({.normal = {bad, 0.5f, bad}, .color = {0.25f, bad, bad}});
    EXPECT_EQ(packed.normal_color[0], 0) << bad;
    EXPECT_EQ(packed.normal_color[1], 128) << bad;
    EXPECT_EQ(packed.normal_color[2], 0) << bad;
    EXPECT_EQ(packed.normal_color[3], 128) << bad;
    EXPECT_EQ(packed.normal_color[4], 0) << bad;
    EXPECT_EQ(packed.normal_color[5], 0) << bad;
    EXPECT_TRUE(shows_surface(packed));
  }
}

TEST(PackedGuides, WithoutIdOrDepthThereIsNoSurface) {
  for (const Guide& guide : {Guide{.id = 0}, Guide{.depth = 0.0f}, Guide{.depth = -1.0f},
                             Guide{.depth = kInf}, Guide{.depth = kNan}}) {
    const PackedGuide none = pack(guide);
    EXPECT_FALSE(shows_surface(none));
    EXPECT_EQ(none.depth, 0);
    EXPECT_EQ(guide_weight(none, pack({})), 0.0f);
    EXPECT_EQ(guide_weight(pack({}), none), 0.0f);
    // Whatever its depth: 1 packs to 0, as that of no surface does.
    EXPECT_EQ(guide_weight(pack({.depth = 1.0f}), none), 0.0f);
    EXPECT_EQ(guide_weight(none, none), 1.0f);
  }
}

TEST(PackedGuides, MeanNormalsTakeThePlaceOfNormals) {
  FrameInput frame;
  frame.resize_input({1, 1});
  frame.surface.id(0, 0) = 1;
  frame.surface.depth(0, 0) = 1.0f;
  frame.surface.normal[1](0, 0) = 1.0f;
  frame.mean_normal = make_planes<3>({1, 1});
  frame.mean_normal[1](0, 0) = 0.5f;
  Plane<PackedGuide> out({3, 2});
  pack_guides(frame, {}, out);
  EXPECT_EQ(out.extent(), (Extent{1, 1}));
  EXPECT_EQ(out(0, 0).normal_color[1], 128);
}

TEST(GuideWeight, IsCloseToTheExponential) {
  const GuideWidths widths{.normal = 1.5f, .color = 0.8f, .depth = 0.6f};
  double least = 1.0, most = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Guide a = random_guide(i), b = random_guide(i + 5000);
    const double square = square_apart(a, b, widths);
    const auto weight = static_cast<double>(guide_weight(pack(a, widths), pack(b, widths)));
    // (1 - x/8)^8 lies below exp(-x), by 0.0354 at most; steps add some 0.01.
    EXPECT_LT(weight, std::exp(-square) + 0.01);
    EXPECT_GT(weight, std::exp(-square) - 0.045);
    const double exact = square < 8.0 ? std::pow(1.0 - square / 8.0, 8.0) : 0.0;
    EXPECT_NEAR(weight, exact, 0.01);
    least = std::min(least, weight), most = std::max(most, weight);
  }
  EXPECT_LT(least, 0.01);
  EXPECT_GT(most, 0.7);
}

TEST(GuideWeight, IsTheSameBothWays) {
  for (int i = 0; i < 500; ++i) {
    const PackedGuide a = pack(random_guide(i)), b = pack(random_guide(i + 5000));
    EXPECT_EQ(guide_weight(a, b), guide_weight(b, a));
    EXPECT_EQ(guide_weight(a, b, 70), guide_weight(b, a, -70));
    EXPECT_EQ(guide_weight(a, a), 1.0f);
  }
}

// The largest differences of all values: their squares must not overflow to a weight.
TEST(GuideWeight, OfTheLargestDifferencesIsZero) {
  const GuideWidths narrow{.normal = 0.01f, .color = 0.01f, .depth = 0.01f};
  const PackedGuide a = pack({.normal = {2, 2, 2}, .color = {2, 2, 2}, .depth = 1e9f}, narrow);
  const PackedGuide b = pack({.normal = {-2, -2, -2}, .color = {0, 0, 0}, .depth = 1e-9f}, narrow);
  const PackedGuide c = pack({.normal = {-2, -2, -2}, .color = {0, 0, 0}, .id = 0}, narrow);
  EXPECT_EQ(guide_weight(a, b), 0.0f);
  EXPECT_EQ(guide_weight(b, a, depth_steps(1e9f, narrow)), 0.0f);
  EXPECT_EQ(guide_weight(a, c), 0.0f);
}

TEST(GuideWeight, StepsOfDepthCancelAKnownChange) {
  for (const float change : {-2.0f, -0.31f, 0.0f, 0.05f, 1.7f}) {
    const PackedGuide here = pack({.depth = 3.0f});
    const PackedGuide there = pack({.depth = 3.0f * std::exp(change)});
    EXPECT_GT(guide_weight(here, there, depth_steps(change, {})), 0.9998f) << change;
    EXPECT_GT(guide_weight(there, here, depth_steps(-change, {})), 0.9998f) << change;
    if (std::abs(change) > 0.3f) {
      EXPECT_LT(guide_weight(here, there), 0.75f);
      EXPECT_LT(guide_weight(here, there, depth_steps(-change, {})), 0.75f);
    }
  }
}

TEST(GuideWeight, WidthsAreChecked) {
  EXPECT_THAT([] { GuideWidths{.normal = 0.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("normal 0")));
  EXPECT_THAT([] { GuideWidths{.color = 11.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("color 11")));
  EXPECT_THAT([] { GuideWidths{.depth = -1.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("depth -1")));
}

}  // namespace
}  // namespace eigenlight
