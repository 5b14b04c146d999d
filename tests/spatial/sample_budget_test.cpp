#include "spatial/sample_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/float_traps.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

struct Scene {
  explicit Scene(Extent extent, std::uint32_t seed = 1)
      : frame(make_random_frame({.extent = extent, .seed = seed}, 2)), age(extent), extra(extent) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        PixelRandom random(seed, x, y);
        // Half of the pixels are old, a fifth are new, and the rest lie in between.
        const float kind = random.uniform();
        age(x, y) = kind < 0.2f ? 0.0f : kind < 0.5f ? random.between(0.0f, 16.0f) : 64.0f;
      }
    }
  }
  BudgetStats run(const BudgetOptions& options) {
    SampleBudget budget(age.extent(), options);
    return budget.process(frame, age, extra);
  }
  [[nodiscard]] std::int64_t surface() const {
    return count([](int) { return 1; });
  }
  [[nodiscard]] std::int64_t granted() const {
    return count([](int samples) { return samples; });
  }
  // Sum of value(extra) over the pixels with surface.
  template <typename Value>
  [[nodiscard]] std::int64_t count(const Value& value) const {
    std::int64_t sum = 0;
    for (int y = 0; y < age.height(); ++y) {
      for (int x = 0; x < age.width(); ++x) {
        if (frame.surface.id(x, y) != 0) sum += value(extra(x, y));
      }
    }
    return sum;
  }
  Frame frame;
  Plane<float> age;
  Plane<std::uint8_t> extra;
};

// The highest level in whole samples that the limit allows, by trying every level.
int brute_force_level(const Scene& scene, const BudgetOptions& options) {
  const int spp = scene.frame.spp;
  const double limit = options.share * spp * static_cast<double>(scene.surface());
  const int highest =
      static_cast<int>(std::min(255.0f, (options.enough - 1.0f) * static_cast<float>(spp)));
  int best = 0;
  for (int level = 0; level <= highest; ++level) {
    std::int64_t cost = 0;
    for (int y = 0; y < scene.age.height(); ++y) {
      for (int x = 0; x < scene.age.width(); ++x) {
        if (scene.frame.surface.id(x, y) == 0) continue;
        const int held = static_cast<int>(std::round(scene.age(x, y) * static_cast<float>(spp)));
        cost += std::clamp(level - held, 0, options.most_per_pixel);
      }
    }
    if (static_cast<double>(cost) <= limit) best = level;
  }
  return best;
}

// A damaged state can hold such ages; they must not become indices.
TEST(SampleBudget, InvalidAgesCountAsNew) {
  const BudgetOptions options{.share = 20.0};
  Scene fresh({16, 4});
  fresh.age.fill(0.0f);
  const std::int64_t wanted = fresh.run(options).samples;
  for (const float age : {std::numeric_limits<float>::quiet_NaN(), -1e14f, -1.0f}) {
    Scene damaged({16, 4});
    damaged.age.fill(age);
    EXPECT_EQ(damaged.run(options).samples, wanted) << age;
  }
}

void expect_level(const Scene& scene, const BudgetStats& stats, int level, int most) {
  EXPECT_EQ(stats.level, 1.0f + static_cast<float>(level) / 3.0f);
  EXPECT_EQ(stats.samples, scene.granted());
  for (int y = 0; y < scene.age.height(); ++y) {
    for (int x = 0; x < scene.age.width(); ++x) {
      const int held = static_cast<int>(std::round(scene.age(x, y) * 3.0f));
      const int wanted = scene.frame.surface.id(x, y) == 0 ? 0 : std::clamp(level - held, 0, most);
      ASSERT_EQ(scene.extra(x, y), wanted) << x << ", " << y;
    }
  }
}

EL_KERNEL_TEST(SampleBudget, MatchesBruteForce) {
  for (const double share : {0.0, 0.05, 0.3, 1.0, 20.0}) {
    for (const int most : {0, 3, 120}) {
      const BudgetOptions options{share, most, 12.0f};
      const int level = brute_force_level(Scene(extent), options);
      on_every_target([&] {
        Scene scene(extent);
        const BudgetStats stats = scene.run(options);
        expect_level(scene, stats, level, most);
      });
    }
  }
}

TEST(SampleBudget, NeverExceedsTheLimit) {
  for (std::uint32_t seed = 1; seed < 20; ++seed) {
    for (const double share : {0.01, 0.1, 0.5, 2.0}) {
      Scene scene({65, 17}, seed);
      const BudgetStats stats = scene.run({share, 120, 200.0f});
      EXPECT_EQ(stats.samples, scene.granted());
      EXPECT_LE(static_cast<double>(stats.samples),
                share * 3.0 * static_cast<double>(scene.surface()));
    }
  }
}

TEST(SampleBudget, ServesTheYoungestFirst) {
  Scene scene({65, 17});
  const BudgetStats stats = scene.run({0.3, 255, 12.0f});
  ASSERT_GT(stats.samples, 0);
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 65; ++x) {
      if (scene.frame.surface.id(x, y) == 0) {
        EXPECT_EQ(scene.extra(x, y), 0);
        continue;
      }
      // With this frame's samples, every pixel reaches the level, and pixels above it get no extra
      // samples, up to rounding by half a sample.
      const float after = scene.age(x, y) + 1.0f + static_cast<float>(scene.extra(x, y)) / 3.0f;
      constexpr float kHalf = 0.5f / 3.0f + 1e-4f;
      EXPECT_GE(after, stats.level - kHalf) << x << ", " << y;
      EXPECT_TRUE(scene.extra(x, y) == 0 || after < stats.level + kHalf) << x << ", " << y;
    }
  }
}

TEST(SampleBudget, CapsTheSamplesOfAPixel) {
  Scene scene({65, 17});
  scene.run({100.0, 5, 12.0f});
  std::int64_t most = 0;
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 65; ++x) {
      most = std::max<std::int64_t>(most, scene.extra(x, y));
      EXPECT_TRUE(scene.age(x, y) <= 11.0f || scene.extra(x, y) == 0);
    }
  }
  EXPECT_EQ(most, 5);
}

TEST(SampleBudget, IsZeroWithoutSurfaceOrShare) {
  Scene scene({65, 17});
  EXPECT_EQ(scene.run({0.0, 120, 12.0f}).samples, 0);
  EXPECT_EQ(scene.granted(), 0);
  scene.frame.surface.id.fill(0);
  const BudgetStats stats = scene.run({1.0, 120, 12.0f});
  EXPECT_EQ(stats.samples, 0);
  EXPECT_EQ(stats.pixels, 0);
}

TEST(SampleBudget, CountsThePixelsItServes) {
  Scene scene({191, 107});
  const BudgetStats stats = scene.run({0.5, 120, 12.0f});
  EXPECT_EQ(stats.pixels, scene.count([](int samples) { return samples > 0 ? 1 : 0; }));
}

TEST(SampleBudget, RejectsOtherExtentsAndBadOptions) {
  const FloatTrapsOff nan_is_meant;
  Scene scene({65, 17});
  SampleBudget other({64, 17}, {});
  EXPECT_THROW((void)other.process(scene.frame, scene.age, scene.extra), std::invalid_argument);
  const auto refused = [](double share, int most, float enough) {
    EXPECT_THROW(SampleBudget({8, 8}, {share, most, enough}), std::invalid_argument);
  };
  refused(-0.1, 120, 12.0f);
  refused(101.0, 120, 12.0f);
  refused(1.0, -1, 12.0f);
  refused(1.0, 256, 12.0f);
  refused(1.0, 120, 0.5f);
  refused(1.0, 120, std::nanf(""));
}

}  // namespace
}  // namespace eigenlight
