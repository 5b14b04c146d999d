#include "temporal/eigen/direct_denoiser.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/analytic_source.h"
#include "tests/support/denoiser_checks.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{64, 48};

AnalyticOptions wall(int frames) {
  return {.extent = kExtent, .frames = frames, .spp = 3, .noise = 1.0f, .pattern = 0.0f};
}

// Light of a sun: an edge that no guide shows and that goes on with the frames.
Planes<3> edge_at(int frame) {
  Planes<3> sun = make_planes<3>(kExtent);
  for (auto& plane : sun) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) plane(x, y) = x < 20 + 2 * frame ? 0.0f : 5.0f;
    }
  }
  return sun;
}

double squared_error(const AnalyticSource& truth, const Planes<3>& light, int frame) {
  double sum = 0.0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const auto d = static_cast<double>(light[0](x, y) - truth.truth({x, y}, 0, frame));
      sum += d * d;
    }
  }
  return sum;
}

TEST(DirectDenoiser, DenoisesSoftLightAndLeavesTheSun) {
  AnalyticSource source(wall(12));
  DirectDenoiser denoiser({.extent = kExtent});
  Frame frame;
  while (source.next(frame)) {
    const Planes<3> sun = edge_at(frame.index);
    denoiser.step(frame, sun, frame.lights[0].radiance);
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        ASSERT_EQ(denoiser.output()[2](x, y), sun[2](x, y) + denoiser.soft()[2](x, y));
      }
    }
  }
  EXPECT_LT(squared_error(source, denoiser.soft(), 11),
            0.02 * squared_error(source, frame.lights[0].radiance, 11));
}

// A sky that the rays of one pixel in five meet. A bound of fireflies, or gains by inner products,
// would take a sixth of its light.
TEST(DirectDenoiser, KeepsLightThatFewRaysMeet) {
  AnalyticOptions options = wall(24);
  options.edit = [](Frame& frame) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        const auto key = hash_key(static_cast<std::uint32_t>(frame.index),
                                  static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
        const float met = to_unit(key) < 0.2f ? 5.0f : 0.0f;
        for (auto& plane : frame.lights[0].radiance) plane(x, y) = met;
      }
    }
  };
  AnalyticSource source(options);
  DirectDenoiser denoiser({.extent = kExtent});
  double light = 0.0, count = 0.0;
  for (Frame frame; source.next(frame);) {
    denoiser.step(frame, frame.direct, frame.lights[0].radiance);
    if (frame.index < 4) continue;
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x)
        light += static_cast<double>(denoiser.soft()[0](x, y));
    }
    count += static_cast<double>(kExtent.pixels());
  }
  EXPECT_NEAR(light / count, 1.0, 0.015);
}

TEST(DirectDenoiser, GoesOnFromItsStateWithTheSameBits) {
  AnalyticSource source(wall(8));
  DirectDenoiser whole({.extent = kExtent}), later({.extent = kExtent});
  for (Frame frame; source.next(frame);) {
    const Planes<3> sun = edge_at(frame.index);
    whole.step(frame, sun, frame.lights[0].radiance);
    if (frame.index == 4) {
      StateWriter state;
      whole.save(state);
      StateReader reader({state.bytes().data(), state.bytes().size()});
      later.load(reader);
      reader.finish();
    } else if (frame.index > 4) {
      later.step(frame, sun, frame.lights[0].radiance);
      EXPECT_TRUE(same_bits(later.output(), whole.output())) << frame.index;
    }
  }
}

TEST(DirectDenoiser, RefusesLightOfAnotherSize) {
  AnalyticSource source(wall(1));
  Frame frame;
  ASSERT_TRUE(source.next(frame));
  DirectDenoiser denoiser({.extent = kExtent});
  EXPECT_THROW(denoiser.step(frame, make_planes<3>({8, 8}), frame.lights[0].radiance),
               std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
