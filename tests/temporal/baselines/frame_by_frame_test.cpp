#include "temporal/baselines/frame_by_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "temporal/methods.h"
#include "tests/support/analytic_source.h"

namespace eigenlight {
namespace {

TEST(FrameByFrame, ReturnsTheRawFrame) {
  AnalyticOptions options;
  options.sky_columns = 10;
  AnalyticSource source(options);
  FrameByFrame noisy({options.extent, 3}, "noisy");
  for (int frame = 0; frame < options.frames; ++frame) {
    const Planes<3>* out = noisy.step(source);
    ASSERT_NE(out, nullptr);
    EXPECT_EQ(noisy.report().frame, frame);
    EXPECT_EQ(noisy.report().surface_pixels, 54 * 36);
    EXPECT_EQ(noisy.report().new_pixels, 54 * 36);
    EXPECT_EQ(noisy.report().rays, 64 * 36 * 3);
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_EQ((*out)[1](x, y), noisy.frame().lights[0].radiance[1](x, y));
        ASSERT_EQ(noisy.age()(x, y), x < 10 ? 0.0f : 1.0f);
      }
    }
  }
  EXPECT_EQ(noisy.step(source), nullptr);
}

TEST(FrameByFrame, NonFinitePixelsAreZeroAndCounted) {
  AnalyticOptions options;
  options.edit = [](Frame& frame) {
    frame.lights[0].radiance[0](3, 4) = std::numeric_limits<float>::quiet_NaN();
    frame.lights[0].radiance[2](5, 6) = std::numeric_limits<float>::infinity();
    frame.non_finite_samples = 7;
  };
  AnalyticSource source(options);
  FrameByFrame noisy({options.extent, 3}, "noisy");
  const Planes<3>* out = noisy.step(source);
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(noisy.report().non_finite_pixels, 2);
  EXPECT_EQ(noisy.report().non_finite_samples, 7);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ((*out)[c](3, 4), 0.0f);
    EXPECT_EQ((*out)[c](5, 6), 0.0f);
    EXPECT_GT((*out)[c](4, 4), 0.0f);
  }
}

TEST(FrameByFrame, RejectsOtherSizesAndStates) {
  AnalyticSource source({});
  FrameByFrame noisy({{63, 36}, 3}, "noisy");
  EXPECT_THROW((void)noisy.step(source), std::invalid_argument);
  StateWriter other;
  other.value("mean", 1u);
  StateReader reader({other.bytes().data(), other.bytes().size()});
  EXPECT_THROW(noisy.load(reader), std::runtime_error);
}

TEST(Methods, AreFoundByName) {
  for (const Method& method : methods()) {
    EXPECT_NE(make_denoiser(method.name, {{8, 8}, 2}), nullptr);
    EXPECT_FALSE(method.what.empty());
  }
  EXPECT_THROW((void)make_denoiser("nothing", {{8, 8}, 2}), std::invalid_argument);
  EXPECT_THROW((void)make_denoiser("noisy", {{8, 8}, 9}), std::invalid_argument);
  EXPECT_THROW((void)make_denoiser("noisy", {{8, 0}, 3}), std::invalid_argument);
}

TEST(Methods, RunWithoutEachOfTheirParts) {
  for (const Method& method : methods()) {
    for (const Part& part : method.parts) {
      AnalyticSource source({});
      const auto denoiser =
          make_denoiser(method.name, {.extent = {64, 36}, .without = {std::string(part.name)}});
      while (denoiser->step(source) != nullptr) {
        ASSERT_TRUE(std::isfinite(denoiser->report().mean_rank)) << part.name;
      }
      EXPECT_FALSE(part.what.empty());
    }
    EXPECT_THROW((void)make_denoiser(method.name, {.extent = {8, 8}, .without = {"nothing"}}),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace eigenlight
