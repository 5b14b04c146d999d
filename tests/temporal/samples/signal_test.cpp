#include "temporal/samples/signal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/reference/signal.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

struct Scene {
  explicit Scene(Extent extent)
      : frame(make_random_frame({.extent = extent}, 1)),
        age(random_plane(extent, 3, -3.0f, 20.0f)),
        extra(extent),
        extra_mean(make_planes<3>(extent)),
        light(make_planes<3>(extent)),
        samples(extent),
        variance(random_plane(extent, 4, 1.0f, 2.0f)),
        brightness(random_plane({(extent.width + 7) / 8, (extent.height + 7) / 8}, 5, 0.5f, 4.0f)) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        PixelRandom random(8, x, y);
        age(x, y) = std::max(age(x, y), 0.0f);
        extra(x, y) = static_cast<std::uint8_t>(
            random.between(-60.0f, 121.0f) > 0.0f ? random.between(1.0f, 121.0f) : 0.0f);
        for (auto& plane : extra_mean) {
          plane(x, y) = extra(x, y) > 0 ? random.between(0.0f, 2.0f)
                                        : std::numeric_limits<float>::quiet_NaN();
        }
      }
    }
  }
  [[nodiscard]] TileGrid grid() const { return {frame.extent(), 32, 32}; }
  [[nodiscard]] SignalInputs in(bool resampled) const {
    return {frame, frame.lights[0].radiance, resampled ? &extra : nullptr,
            resampled ? &extra_mean : nullptr, age};
  }
  PixelCounts merge(bool resampled) {
    PerTile<PixelCounts> counts(grid());
    for_each_tile(grid(), [&](const Tile& tile) {
      counts[tile] = merge_samples(in(resampled), tile, {light, samples});
    });
    PixelCounts sum;
    for (const PixelCounts& found : counts) {
      sum += found;
    }
    return sum;
  }

  Frame frame;
  Plane<float> age;
  Plane<std::uint8_t> extra;
  Planes<3> extra_mean, light;
  Plane<float> samples, variance, brightness;
};

void expect_merged(const Scene& scene, bool resampled, const PixelCounts& counts) {
  std::int64_t fresh = 0, non_finite = 0;
  for (int y = 0; y < scene.light[0].height(); ++y) {
    for (int x = 0; x < scene.light[0].width(); ++x) {
      const auto twin = reference::merged_samples(scene.in(resampled), x, y);
      const bool surface = scene.frame.surface.id(x, y) != 0;
      fresh += surface && scene.age(x, y) == 0.0f ? 1 : 0;
      non_finite += surface && twin.samples == 0.0 ? 1 : 0;
      ASSERT_NEAR(scene.samples(x, y), twin.samples, 1e-5);
      for (std::size_t c = 0; c < 3; ++c) {
        if (twin.samples > 0.0) {
          ASSERT_NEAR(scene.light[c](x, y), twin.light[c], 1e-6 * (1.0 + twin.light[c]))
              << x << ", " << y;
        } else {
          ASSERT_TRUE(std::isnan(scene.light[c](x, y)));
        }
      }
    }
  }
  EXPECT_EQ(counts.fresh, fresh);
  EXPECT_EQ(counts.non_finite, non_finite);
}

EL_KERNEL_TEST(MergeSamples, MatchesTheReference) {
  on_every_target([&] {
    for (const bool resampled : {false, true}) {
      Scene scene(extent);
      const PixelCounts counts = scene.merge(resampled);
      expect_merged(scene, resampled, counts);
    }
  });
}

TEST(MergeSamples, LightWhoseSquareOverflowsIsNotUsable) {
  Scene scene({16, 16});
  for (auto& plane : scene.frame.lights[0].radiance) plane.fill(1.0f);
  scene.frame.surface.id.fill(1);
  scene.frame.lights[0].radiance[1](3, 4) = 1e19f;
  EXPECT_EQ(scene.merge(false).non_finite, 1);
  EXPECT_EQ(scene.samples(3, 4), 0.0f);
}

EL_KERNEL_TEST(FreshVariance, MatchesTheReferenceAtNewPixelsOnly) {
  Scene before(extent);
  (void)before.merge(true);
  on_every_target([&] {
    Scene scene(extent);
    (void)scene.merge(true);
    for_each_tile(scene.grid(), [&](const Rect& tile) {
      fresh_variance(
          {scene.frame, scene.frame.lights[0].radiance, scene.samples, scene.age, scene.brightness},
          tile, scene.variance);
    });
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const bool fresh = scene.frame.surface.id(x, y) != 0 && scene.age(x, y) == 0.0f;
        const double wanted =
            fresh ? reference::fresh_variance(before.frame.lights[0].radiance, before.samples,
                                              before.brightness, {x, y})
                  : before.variance(x, y);
        ASSERT_NEAR(scene.variance(x, y), wanted, 1e-6) << x << ", " << y;
      }
    }
  });
}

EL_KERNEL_TEST(EstimateVariance, FallsWithAgeAndMarksYoungPixels) {
  const Scene scene(extent);
  on_every_target([&] {
    Plane<float> estimate(extent);
    Plane<std::uint8_t> young(extent);
    for_each_tile(scene.grid(), [&](const Rect& tile) {
      estimate_variance({scene.frame.surface.id, scene.age, scene.variance, 2.0f}, tile,
                        {estimate, young});
    });
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const float age = scene.age(x, y);
        ASSERT_FLOAT_EQ(estimate(x, y), age > 0.0f ? scene.variance(x, y) / age : 0.0f);
        ASSERT_EQ(young(x, y) != 0, scene.frame.surface.id(x, y) != 0 && age < 2.0f);
      }
    }
  });
}

}  // namespace
}  // namespace eigenlight
