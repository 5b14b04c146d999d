#include "temporal/change/innovation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/reference/innovation.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Scene {
  explicit Scene(Extent extent)
      : innovation(extent), age(extent), samples(extent), new_age(extent), variance(extent) {
    age.fill(10.0f);
    samples.fill(1.0f);
  }
  [[nodiscard]] InnovationInputs in() const { return {innovation, age, samples}; }
  // Noise of standard deviation 1 around `mean`.
  void set_noise(float mean) {
    for (int y = 0; y < innovation.height(); ++y) {
      for (int x = 0; x < innovation.width(); ++x) {
        innovation(x, y) = mean + PixelRandom(4, x, y).between(-1.732f, 1.732f);
      }
    }
  }
  void run(const InnovationOptions& options = {}) {
    for_each_tile(TileGrid(innovation.extent(), 32, 32), [&](const Rect& tile) {
      innovation_tile(in(), options, tile, {new_age, variance});
    });
  }
  Plane<float> innovation, age, samples, new_age, variance;
};

// All kinds of pixels: new, unusable, resampled, and biased on one side of the image.
Scene mixed(Extent extent) {
  Scene scene(extent);
  scene.set_noise(0.0f);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      PixelRandom random(6, x, y);
      if (x > extent.width / 2) scene.innovation(x, y) += 0.8f;
      scene.age(x, y) = random.between(1.0f, 64.0f);
      scene.samples(x, y) = random.uniform() < 0.1f ? 4.0f : 1.0f;
      scene.variance(x, y) = random.between(0.1f, 2.0f);
      if (random.uniform() < 0.15f) {
        scene.innovation(x, y) = kNan;
        scene.age(x, y) = random.uniform() < 0.5f ? 0.0f : scene.age(x, y);
        // An unusable pixel has no samples; a bounded one has.
        if (scene.age(x, y) > 0.0f && random.uniform() < 0.5f) scene.samples(x, y) = 0.0f;
      }
    }
  }
  return scene;
}

EL_KERNEL_TEST(Innovation, MatchesTheReference) {
  const Scene before = mixed(extent);
  on_every_target([&] {
    Scene scene = mixed(extent);
    scene.run();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const auto twin = reference::innovation(before.in(), {}, {x, y}, before.variance(x, y));
        // The variance is a difference of float sums of 81 squares. Where the bias is just above
        // chance, the difference of both loses another digit.
        ASSERT_NEAR(scene.new_age(x, y), twin.age, 1e-3 * twin.age) << x << ", " << y;
        ASSERT_NEAR(scene.variance(x, y), twin.variance, 1e-5 * std::max(twin.variance, 0.1))
            << x << ", " << y;
      }
    }
  });
}

TEST(Innovation, AgeIsUpdatedInPlace) {
  Scene apart = mixed({65, 17}), in_place = mixed({65, 17});
  apart.run();
  const TileGrid grid({65, 17}, 32, 32);
  for (int i = 0; i < grid.count(); ++i) {
    innovation_tile(in_place.in(), {}, grid.tile(i), {in_place.age, in_place.variance});
  }
  EXPECT_TRUE(planes_equal(in_place.age, apart.new_age));
  EXPECT_TRUE(planes_equal(in_place.variance, apart.variance));
}

TEST(Innovation, AgesAddUpAndSaturateWithoutBias) {
  Scene scene({64, 32});
  scene.set_noise(0.0f);
  for (const float age : {1.0f, 10.0f, 40.0f}) {
    scene.age.fill(age);
    scene.samples.fill(2.5f);
    InnovationOptions options;
    options.threshold = 100.0f;  // ten standard errors, which noise never reaches
    scene.run(options);
    EXPECT_NEAR(scene.new_age(31, 15), age + 2.5f, 1e-4f);
    options.max_age = age + 2.0f;
    scene.run(options);
    EXPECT_EQ(scene.new_age(31, 15), options.max_age);
  }
}

// With n = 10 and s = 1, 1 / (age - 1) = w / (1 - w) = 0.1 + (mu^2 - 2 (1 + 1/10) v / 81) / v. Here
// v = 1 and mu = b on average, E[mu^2] = b^2 + 1 / 81 and E[1 / v] = 1.02 over windows of uniform
// noise. The image holds some 250 independent windows, so the mean varies by 2 b / 9 / sqrt(250) =
// 0.014 b through mu and by 0.6 % through v. The bound is three times both.
TEST(Innovation, BiasShortensTheMemory) {
  for (const double bias : {0.5, 1.0, 3.0, 100.0}) {
    Scene scene({191, 107});
    scene.set_noise(static_cast<float>(bias));
    scene.run();
    double sum = 0.0;
    for (int y = 4; y < 103; ++y) {
      for (int x = 4; x < 187; ++x) sum += 1.0 / (static_cast<double>(scene.new_age(x, y)) - 1.0);
    }
    const double wanted = 0.1 + 1.02 * (bias * bias - 1.2 / 81.0);
    EXPECT_NEAR(sum / (183.0 * 99.0), wanted, 0.042 * bias + 0.019 * wanted) << bias;
  }
}

TEST(Innovation, NoiseAloneRarelyShortensTheMemory) {
  Scene scene({191, 107});
  scene.set_noise(0.0f);
  scene.run();
  int shortened = 0;
  for (int y = 0; y < 107; ++y) {
    for (int x = 0; x < 191; ++x) shortened += scene.new_age(x, y) < 10.9f ? 1 : 0;
  }
  // 16 % of the window means are beyond sqrt(2) standard errors.
  EXPECT_NEAR(shortened / (191.0 * 107.0), 0.157, 0.06);
}

TEST(Innovation, NewPixelsStartAndUnusablePixelsKeepTheirState) {
  Scene scene({9, 9});
  scene.set_noise(0.0f);
  scene.age(4, 4) = 0.0f;
  scene.innovation(4, 4) = kNan;
  scene.samples(4, 4) = 7.0f;
  scene.age(2, 2) = 23.0f;
  scene.innovation(2, 2) = kNan;
  scene.samples(2, 2) = 0.0f;
  scene.variance(2, 2) = 0.5f;
  scene.run();
  EXPECT_EQ(scene.new_age(4, 4), 7.0f);
  EXPECT_EQ(scene.new_age(2, 2), 23.0f);
  EXPECT_EQ(scene.variance(2, 2), 0.5f);
}

// A single pixel has no local mean to test.
TEST(Innovation, SinglePixelGrowsOlder) {
  Scene scene({1, 1});
  scene.innovation(0, 0) = 0.5f;
  scene.samples(0, 0) = 2.0f;
  scene.run();
  EXPECT_EQ(scene.new_age(0, 0), 12.0f);
}

// The weight of a frame is samples / age, which must not exceed 1.
TEST(Innovation, AgeIsNeverBelowTheSamplesOfTheFrame) {
  Scene scene({65, 17});
  for (const float bias : {0.0f, 2.0f, 1e6f}) {
    for (const float samples : {1.0f, 40.0f, 121.0f}) {
      scene.set_noise(bias);
      scene.samples.fill(samples);
      scene.run();
      EXPECT_GE(scene.new_age(31, 9), samples * (1.0f - 1e-6f)) << bias << " " << samples;
    }
  }
}

TEST(Innovation, PerfectPredictionLowersTheVariance) {
  Scene scene({65, 17});
  scene.variance.fill(1.0f);
  scene.run();
  EXPECT_NEAR(scene.new_age(40, 8), 11.0f, 1e-4f);
  EXPECT_NEAR(scene.variance(40, 8), 1.0f - 1.0f / 11.0f, 1e-6f);
}

TEST(InnovationOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  const auto rejects = [](float threshold, float max_age) {
    EXPECT_THROW((InnovationOptions{threshold, max_age}.validate()), std::invalid_argument);
  };
  rejects(-0.1f, 64.0f);
  rejects(101.0f, 64.0f);
  rejects(2.0f, 0.5f);
  rejects(2.0f, 256.0f);
  rejects(std::numeric_limits<float>::quiet_NaN(), 64.0f);
  rejects(2.0f, std::numeric_limits<float>::quiet_NaN());
  EXPECT_NO_THROW(InnovationOptions{}.validate());
}

}  // namespace
}  // namespace eigenlight
