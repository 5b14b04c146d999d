#include "spatial/guided_filter.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "frame/float_traps.h"
#include "frame/random.h"
#include "tests/reference/guided_filter.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

float random(int x, int y, std::uint32_t what) {
  return to_unit(hash_key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), what));
}

// A room corner: two walls that meet at a vertical edge, a nearer box before them, noisy light,
// some sky, and pixels whose sample is missing.
struct Case {
  explicit Case(Extent size)
      : extent(size), signal(make_planes<3>(size)), weight(size), wanted(size) {
    frame.resize(size);
    wanted.fill(1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) fill(x, y);
    }
  }

  void fill(int x, int y) {
    const bool left = 2 * x < extent.width;
    const bool box = (x / 11 + y / 7) % 3 == 0;
    auto& s = frame.surface;
    s.id(x, y) = random(x / 9, y / 9, 1) < 0.9f ? 1 : 0;
    s.depth(x, y) = box ? 3.0f + 0.01f * static_cast<float>(y)
                        : 6.0f + 0.02f * static_cast<float>(left ? x : extent.width - x);
    if (s.id(x, y) == 0) s.depth(x, y) = kInf;
    const float normal[3] = {left ? 0.8f : -0.8f, 0.0f, 0.6f};
    for (std::size_t c = 0; c < 3; ++c) {
      s.normal[c](x, y) = box ? (c == 1 ? 1.0f : 0.0f) : normal[c];
      signal[c](x, y) =
          (left ? 1.0f : 0.3f) * (0.2f + 1.6f * random(x, y, 10 + static_cast<std::uint32_t>(c)));
    }
    weight(x, y) = random(x, y, 2) < 0.2f ? 0.0f : 8.0f * random(x, y, 3);
  }

  [[nodiscard]] GuidedInputs inputs() const { return {frame, signal, weight, wanted}; }

  [[nodiscard]] Planes<3> filter(const GuidedOptions& options = {}) const {
    Planes<3> out = make_planes<3>(extent);
    EXPECT_EQ(GuidedFilter(extent, options).process(inputs(), out), 0);
    return out;
  }

  void flat_wall() {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        frame.surface.id(x, y) = 1;
        frame.surface.depth(x, y) = 5.0f;
        for (std::size_t c = 0; c < 3; ++c) frame.surface.normal[c](x, y) = c == 2 ? 1.0f : 0.0f;
        weight(x, y) = 1.0f;
      }
    }
  }

  Extent extent;
  Frame frame;
  Planes<3> signal;
  Plane<float> weight;
  Plane<std::uint8_t> wanted;
};

// Largest difference; NaN where one of them is NaN.
double distance(const Planes<3>& a, const Planes<3>& b) {
  double most = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < a[c].height(); ++y) {
      for (int x = 0; x < a[c].width(); ++x) {
        const double d = std::abs(static_cast<double>(a[c](x, y)) - b[c](x, y));
        if (!(d <= most)) most = d;
      }
    }
  }
  return most;
}

class GuidedFilterSizes : public testing::TestWithParam<Extent> {};

TEST_P(GuidedFilterSizes, AgreesWithItsTwin) {
  const Case c(GetParam());
  for (const int radius : {1, 5, 8}) {
    const GuidedOptions options{.radius = radius};
    EXPECT_LT(distance(c.filter(options), reference::guided_filter(c.inputs(), options)), 2e-5)
        << "radius " << radius;
  }
}

INSTANTIATE_TEST_SUITE_P(All, GuidedFilterSizes,
                         testing::Values(Extent{1, 1}, Extent{5, 3}, Extent{64, 16}, Extent{65, 17},
                                         Extent{100, 70}),
                         [](const auto& size) {
                           return fmt::format("{}x{}", size.param.width, size.param.height);
                         });

TEST(GuidedFilter, AgreesWithItsTwinAtWideRadiiAcrossTilesAndStrips) {
  const Case c({140, 80});
  const GuidedOptions options{.radius = 16};
  EXPECT_LT(distance(c.filter(options), reference::guided_filter(c.inputs(), options)), 2e-5);
  const Case small({150, 20});
  const GuidedOptions widest{.radius = 32};
  EXPECT_LT(distance(small.filter(widest), reference::guided_filter(small.inputs(), widest)), 2e-5);
}

TEST(GuidedFilter, AgreesWithItsTwinWithFewerGuidesOnEveryTarget) {
  const Case c({90, 40});
  for (const Guides guides : {Guides::kGrayNormal, Guides::kNormal, Guides::kNormalDepth}) {
    const GuidedOptions options{.radius = 5, .guides = guides};
    const Planes<3> twin = reference::guided_filter(c.inputs(), options);
    for_each_target(
        [&] { EXPECT_LT(distance(c.filter(options), twin), 2e-5) << static_cast<int>(guides); });
  }
}

// Only depth tells the box from the wall behind it, if their normals are the same.
TEST(GuidedFilter, DepthIsAGuideOnlyWithFourOfThem) {
  Case c({96, 64});
  c.flat_wall();
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 48; ++x) {
      c.frame.surface.depth(x, y) = 2.0f;
      for (auto& plane : c.signal) plane(x, y) = 3.0f;
    }
    for (int x = 48; x < 96; ++x) {
      for (auto& plane : c.signal) plane(x, y) = 1.0f;
    }
  }
  EXPECT_GT(c.filter()[0](47, 32), 2.8f);
  EXPECT_NEAR(c.filter({.guides = Guides::kNormal})[0](47, 32), 2.0f, 0.1f);
}

TEST(GuidedFilter, WhatHasNoWeightTouchesNothing) {
  Case clean({100, 70});
  Case dirty({100, 70});
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 100; ++x) {
      const float bad[5] = {kNan, kInf, -kInf, 3e38f, -1e30f};
      const auto pick = static_cast<std::size_t>(5.0f * random(x, y, 50));
      if (clean.weight(x, y) == 0.0f) dirty.signal[pick % 3](x, y) = bad[pick];
      if (clean.frame.surface.id(x, y) == 0) {
        dirty.frame.surface.normal[1](x, y) = kNan;
        dirty.weight(x, y) = 7.0f;
      }
    }
  }
  EXPECT_EQ(distance(clean.filter(), dirty.filter()), 0.0);
}

TEST(GuidedFilter, LightThatIsNotFiniteCountsAsMissing) {
  Case missing({70, 40});
  missing.flat_wall();
  missing.weight(33, 20) = 0.0f;
  Case broken({70, 40});
  broken.flat_wall();
  broken.signal[1](33, 20) = kNan;
  const Planes<3> out = broken.filter();
  EXPECT_EQ(distance(missing.filter(), out), 0.0);
  EXPECT_GT(out[1](33, 20), 0.0f);
}

TEST(GuidedFilter, FlatLightStaysFlatOnAnyGeometry) {
  Case c({130, 70});
  for (auto& plane : c.signal) plane.fill(2.5f);
  const Planes<3> out = c.filter();
  for (int y = 0; y < 70; ++y) {
    for (int x = 0; x < 130; ++x) {
      const bool surface = c.frame.surface.id(x, y) != 0;
      ASSERT_NEAR(out[0](x, y), surface ? 2.5f : 0.0f, 1e-5f) << x << ", " << y;
    }
  }
}

TEST(GuidedFilter, AFireflyLeavesNoTraceOutsideItsWindows) {
  Case c({150, 60});
  c.flat_wall();
  for (auto& plane : c.signal) plane.fill(1.0f);
  c.signal[0](70, 30) = 1e9f;
  const GuidedOptions options{.radius = 4};
  const Planes<3> out = c.filter(options);
  EXPECT_GT(out[0](70, 30), 1e5f);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 150; ++x) {
      if (std::abs(x - 70) > 8 || std::abs(y - 30) > 8) {
        ASSERT_NEAR(out[0](x, y), 1.0f, 1e-6f);
      }
    }
  }
}

// Light that differs between two walls follows the edge of the normals, and the noise on each wall
// falls by what 17 x 17 pixels give.
TEST(GuidedFilter, AnEdgeOfTheGuideStaysAnEdgeAndNoiseFalls) {
  Case c({128, 96});
  c.flat_wall();
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) {
      const bool left = x < 64;
      c.frame.surface.normal[0](x, y) = left ? 1.0f : 0.0f;
      c.frame.surface.normal[2](x, y) = left ? 0.0f : 1.0f;
      for (auto& plane : c.signal) {
        plane(x, y) = (left ? 2.0f : 1.0f) * (0.5f + random(x, y, 9));
      }
    }
  }
  const Planes<3> out = c.filter();
  double error = 0.0;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 128; ++x) error += std::pow((out[0](x, y) - (x < 64 ? 2.0 : 1.0)), 2);
    EXPECT_GT(out[0](63, y), 1.85f);
    EXPECT_LT(out[0](64, y), 1.15f);
  }
  // Variance of the noise is 4 / 12 and 1 / 12.
  EXPECT_LT(error / (96.0 * 128.0), 0.01 * (5.0 / 24.0));
}

TEST(GuidedFilter, KeepsTheMeanOfLight) {
  Case c({128, 128});
  c.flat_wall();
  const Planes<3> out = c.filter();
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      before += static_cast<double>(c.signal[1](x, y));
      after += static_cast<double>(out[1](x, y));
    }
  }
  EXPECT_NEAR(after / before, 1.0, 0.01);
}

TEST(GuidedFilter, HeavyPixelsDecide) {
  Case c({40, 40});
  c.flat_wall();
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool old = (x + y) % 2 == 0;
      c.weight(x, y) = old ? 30.0f : 1.0f;
      for (auto& plane : c.signal) plane(x, y) = old ? 1.0f : 32.0f;
    }
  }
  // Means of windows with one pixel more of one kind: (30 * 145 + 32 * 144) / (30 * 145 + 144).
  EXPECT_NEAR(c.filter()[0](20, 20), 2.0f, 0.02f);
}

TEST(GuidedFilter, NothingUsableGivesZero) {
  Case c({20, 20});
  c.weight.fill(0.0f);
  for (auto& plane : c.signal) plane.fill(kNan);
  const Planes<3> out = c.filter();
  EXPECT_EQ(distance(out, make_planes<3>(c.extent)), 0.0);
}

TEST(GuidedFilter, LeavesTilesAloneThatNobodyWants) {
  Case c({150, 70});
  c.wanted.fill(0);
  c.wanted(100, 69) = 1;
  const Planes<3> all = Case({150, 70}).filter();
  Planes<3> out = make_planes<3>(c.extent);
  for (auto& plane : out) plane.fill(-7.0f);
  GuidedFilter filter(c.extent, {});
  EXPECT_EQ(filter.process(c.inputs(), out), 150 * 70 - 64 * 6);
  EXPECT_EQ(out[0](100, 63), -7.0f);
  EXPECT_EQ(out[0](63, 69), -7.0f);
  EXPECT_EQ(out[0](70, 66), all[0](70, 66));
  EXPECT_NE(out[0](70, 66), -7.0f);
}

// Which tiles are filtered in one go changes no bit.
TEST(GuidedFilter, GivesTheSameBitsWhateverElseIsWanted) {
  for (const int radius : {3, 12}) {
    const GuidedOptions options{.radius = radius};
    Case c({330, 270});
    const Planes<3> all = c.filter(options);
    c.wanted.fill(0);
    for (int y = 0; y < 270; y += 64) {
      for (int x = 0; x < 330; x += 64) c.wanted(x, y) = random(x, y, 70) < 0.5f ? 1 : 0;
    }
    Planes<3> some = make_planes<3>(c.extent);
    GuidedFilter filter(c.extent, options);
    EXPECT_GT(filter.process(c.inputs(), some), 64 * 64);
    for (int y = 0; y < 270; ++y) {
      for (int x = 0; x < 330; ++x) {
        const bool wanted = c.wanted(x / 64 * 64, y / 64 * 64) != 0;
        ASSERT_EQ(some[2](x, y), wanted ? all[2](x, y) : 0.0f) << x << ", " << y;
      }
    }
  }
}

TEST(GuidedFilter, GivesTheSameBitsOnAnyNumberOfThreadsAndAgain) {
  const Case c({191, 107});
  set_thread_count(1);
  const Planes<3> one = c.filter();
  set_thread_count(3);
  const Planes<3> three = c.filter();
  set_thread_count(0);
  Planes<3> again = make_planes<3>(c.extent);
  GuidedFilter filter(c.extent, {});
  for (int i = 0; i < 2; ++i) EXPECT_EQ(filter.process(c.inputs(), again), 0);
  for (int y = 0; y < 107; ++y) {
    const std::size_t bytes = 191 * sizeof(float);
    ASSERT_EQ(std::memcmp(one[2].row(y), three[2].row(y), bytes), 0);
    ASSERT_EQ(std::memcmp(one[2].row(y), again[2].row(y), bytes), 0);
  }
}

TEST(GuidedFilter, RefusesBadOptionsAndSizes) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(GuidedFilter({8, 8}, {.radius = 0}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.radius = 33}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.guides = Guides{2}}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.epsilon_normal = 0.0f}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.epsilon_depth = kNan}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({0, 8}, {}), std::invalid_argument);
  Case c({20, 20});
  Planes<3> out = make_planes<3>({20, 21});
  GuidedFilter filter(c.extent, {});
  EXPECT_THROW(filter.process(c.inputs(), out), std::invalid_argument);
  EXPECT_THROW(filter.process(c.inputs(), c.signal), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
