#include "temporal/samples/signal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

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
  PixelCounts merge(bool resampled) {
    PixelCounts counts;
    for_each([&](const Rect& tile) {
      const PixelCounts found =
          merge_samples({frame, frame.lights[0].radiance, resampled ? &extra : nullptr,
                         resampled ? &extra_mean : nullptr, age},
                        tile, {light, samples});
      counts += found;
    });
    return counts;
  }
  template <typename Body>
  void for_each(Body body) const {
    const TileGrid grid(frame.extent(), 32, 32);
    for (int i = 0; i < grid.count(); ++i) body(grid.tile(i));
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
      const double extra = resampled ? scene.extra(x, y) : 0.0;
      double mean[3], size = 0.0;
      for (std::size_t c = 0; c < 3; ++c) {
        mean[c] = 3.0 * scene.frame.lights[0].radiance[c](x, y);
        if (extra > 0.0) mean[c] += extra * scene.extra_mean[c](x, y);
        mean[c] /= 3.0 + extra;
        size += std::abs(mean[c]);
      }
      const bool surface = scene.frame.surface.id(x, y) != 0;
      const bool usable = surface && std::isfinite(size);
      fresh += surface && scene.age(x, y) == 0.0f ? 1 : 0;
      non_finite += surface && !usable ? 1 : 0;
      ASSERT_NEAR(scene.samples(x, y), usable ? 1.0 + extra / 3.0 : 0.0, 1e-5);
      for (std::size_t c = 0; c < 3; ++c) {
        if (usable) {
          ASSERT_NEAR(scene.light[c](x, y), mean[c], 1e-6 * (1.0 + mean[c])) << x << ", " << y;
        } else {
          ASSERT_TRUE(std::isnan(scene.light[c](x, y)));
        }
      }
    }
  }
  EXPECT_EQ(counts.fresh, fresh);
  EXPECT_EQ(counts.non_finite, non_finite);
}

TEST(MergeSamples, IsTheMeanOfAllSamplesOnEveryTarget) {
  for_each_target([] {
    for (const Extent extent : kSweepExtents) {
      for (const bool resampled : {false, true}) {
        Scene scene(extent);
        const PixelCounts counts = scene.merge(resampled);
        expect_merged(scene, resampled, counts);
      }
    }
  });
}

TEST(MergeSamples, RefusesLightBeyondWhatSquaresHold) {
  Scene scene({16, 16});
  for (auto& plane : scene.frame.lights[0].radiance) plane.fill(1.0f);
  scene.frame.surface.id.fill(1);
  scene.frame.lights[0].radiance[1](3, 4) = 1e19f;
  EXPECT_EQ(scene.merge(false).non_finite, 1);
  EXPECT_EQ(scene.samples(3, 4), 0.0f);
}

// One pixel's window, summed directly.
double variance_around(const Scene& scene, int px, int py) {
  double count = 0.0, sum = 0.0, square = 0.0;
  for (int y = std::max(py - 3, 0); y <= std::min(py + 3, scene.samples.height() - 1); ++y) {
    for (int x = std::max(px - 3, 0); x <= std::min(px + 3, scene.samples.width() - 1); ++x) {
      if (!(scene.samples(x, y) > 0.0f)) continue;
      const auto& u = scene.frame.lights[0].radiance;
      const double most = scene.brightness(x / 8, y / 8);
      const double l =
          std::clamp(0.2126 * u[0](x, y) + 0.7152 * u[1](x, y) + 0.0722 * u[2](x, y), -most, most);
      count += 1.0;
      sum += l;
      square += l * l;
    }
  }
  return count > 1.0 ? std::max(square / count - sum * sum / (count * count), 0.0) : 0.0;
}

TEST(FreshVariance, IsThatOfTheSurroundingsAtNewPixelsAloneOnEveryTarget) {
  for_each_target([] {
    for (const Extent extent : kSweepExtents) {
      Scene scene(extent);
      (void)scene.merge(true);
      const Plane<float> before = scene.variance.clone();
      scene.for_each([&](const Rect& tile) {
        fresh_variance({scene.frame, scene.frame.lights[0].radiance, scene.samples, scene.age,
                        scene.brightness},
                       tile, scene.variance);
      });
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const bool fresh = scene.frame.surface.id(x, y) != 0 && scene.age(x, y) == 0.0f;
          const double wanted = fresh ? variance_around(scene, x, y) : before(x, y);
          ASSERT_NEAR(scene.variance(x, y), wanted, 1e-6) << x << ", " << y;
        }
      }
    }
  });
}

TEST(EstimateVariance, FallsWithAgeAndMarksTheYoung) {
  Scene scene({67, 33});
  Plane<float> estimate({67, 33});
  Plane<std::uint8_t> young({67, 33});
  for_each_target([&] {
    scene.for_each([&](const Rect& tile) {
      estimate_variance({scene.frame.surface.id, scene.age, scene.variance, 2.0f}, tile,
                        {estimate, young});
    });
    for (int y = 0; y < 33; ++y) {
      for (int x = 0; x < 67; ++x) {
        const float age = scene.age(x, y);
        ASSERT_FLOAT_EQ(estimate(x, y), age > 0.0f ? scene.variance(x, y) / age : 0.0f);
        ASSERT_EQ(young(x, y) != 0, scene.frame.surface.id(x, y) != 0 && age < 2.0f);
      }
    }
  });
}

}  // namespace
}  // namespace eigenlight
