#include "temporal/change/innovation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/reference/innovation.h"
#include "tests/support/compare.h"
#include "tests/support/extents.h"
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
    const TileGrid grid(innovation.extent(), 32, 32);
    for (int i = 0; i < grid.count(); ++i) {
      innovation_tile(in(), options, grid.tile(i), {new_age, variance});
    }
  }
  Plane<float> innovation, age, samples, new_age, variance;
};

// All kinds of pixels: new, unconfirmed, resampled, biased on one side of the image.
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
        // Not usable, or bounded.
        if (scene.age(x, y) > 0.0f && random.uniform() < 0.5f) scene.samples(x, y) = 0.0f;
      }
    }
  }
  return scene;
}

TEST(Innovation, AgreesWithTheTwin) {
  for (const Extent extent : kSweepExtents) {
    Scene scene = mixed(extent);
    const Plane<float> before = scene.variance.clone();
    scene.run();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const auto twin =
            reference::innovation(scene.in(), {}, {x, y}, static_cast<double>(before(x, y)));
        // The variance is a difference of float sums of 81 squares; where the bias is just above
        // chance its own difference loses another digit.
        ASSERT_NEAR(scene.new_age(x, y), twin.age, 1e-3 * twin.age) << x << ", " << y;
        ASSERT_NEAR(scene.variance(x, y), twin.variance, 1e-5 * std::max(twin.variance, 0.1))
            << x << ", " << y;
      }
    }
  }
}

TEST(Innovation, AgeMayBeTheInput) {
  Scene apart = mixed({65, 17}), in_place = mixed({65, 17});
  apart.run();
  const TileGrid grid({65, 17}, 32, 32);
  for (int i = 0; i < grid.count(); ++i) {
    innovation_tile(in_place.in(), {}, grid.tile(i), {in_place.age, in_place.variance});
  }
  EXPECT_TRUE(planes_equal(in_place.age, apart.new_age));
  EXPECT_TRUE(planes_equal(in_place.variance, apart.variance));
}

TEST(Innovation, WithoutBiasAgesAddUpAndSaturate) {
  Scene scene({64, 32});
  scene.set_noise(0.0f);
  for (const float age : {1.0f, 10.0f, 40.0f}) {
    scene.age.fill(age);
    scene.samples.fill(2.5f);
    InnovationOptions options;
    options.threshold = 100.0f;  // ten standard errors: chance never gets there
    scene.run(options);
    EXPECT_NEAR(scene.new_age(31, 15), age + 2.5f, 1e-4f);
    options.max_age = age + 2.0f;
    scene.run(options);
    EXPECT_EQ(scene.new_age(31, 15), options.max_age);
  }
}

TEST(Innovation, BiasShortensTheMemory) {
  float before = 11.0f;
  for (const float bias : {0.5f, 1.0f, 3.0f, 100.0f}) {
    Scene scene({64, 32});
    scene.set_noise(bias);
    scene.run();
    // v = 1, n = 10: w / (1 - w) = 0.1 + b^2, hence age = 1 + 1 / (0.1 + b^2).
    const float wanted = 1.0f + 1.0f / (0.1f + bias * bias);
    EXPECT_NEAR(scene.new_age(31, 15), wanted, 0.35f * wanted) << bias;
    EXPECT_LT(scene.new_age(31, 15), before);
    before = scene.new_age(31, 15);
  }
  EXPECT_NEAR(before, 1.0f, 1e-3f);
}

TEST(Innovation, RarelySeesBiasInPureNoise) {
  Scene scene({191, 107});
  scene.set_noise(0.0f);
  scene.run();
  int shortened = 0;
  for (int y = 0; y < 107; ++y) {
    for (int x = 0; x < 191; ++x) shortened += scene.new_age(x, y) < 10.9f ? 1 : 0;
  }
  // A mean beyond sqrt(2) standard errors: 16 % of windows.
  EXPECT_NEAR(shortened / (191.0 * 107.0), 0.157, 0.06);
}

TEST(Innovation, NewPixelsStartAndUnusableOnesWait) {
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

// One pixel alone has no local mean to test, and ages like any other.
TEST(Innovation, ALonePixelAges) {
  Scene scene({1, 1});
  scene.innovation(0, 0) = 0.5f;
  scene.samples(0, 0) = 2.0f;
  scene.run();
  EXPECT_EQ(scene.new_age(0, 0), 12.0f);
}

// Weights are samples / age: an age below the samples would weigh them more than once.
TEST(Innovation, AgeIsNeverBelowTheFramesOwnSamples) {
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

TEST(Innovation, PerfectPredictionAgesAndHasNoVariance) {
  Scene scene({65, 17});
  scene.variance.fill(1.0f);
  scene.run();
  EXPECT_NEAR(scene.new_age(40, 8), 11.0f, 1e-4f);
  EXPECT_NEAR(scene.variance(40, 8), 1.0f - 1.0f / 11.0f, 1e-6f);
}

TEST(InnovationOptions, RefusesWhatIsOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  const auto refused = [](float threshold, float max_age) {
    EXPECT_THROW((InnovationOptions{threshold, max_age}.validate()), std::invalid_argument);
  };
  refused(-0.1f, 64.0f);
  refused(101.0f, 64.0f);
  refused(2.0f, 0.5f);
  refused(2.0f, 256.0f);
  refused(std::numeric_limits<float>::quiet_NaN(), 64.0f);
  refused(2.0f, std::numeric_limits<float>::quiet_NaN());
  EXPECT_NO_THROW(InnovationOptions{}.validate());
}

}  // namespace
}  // namespace eigenlight
