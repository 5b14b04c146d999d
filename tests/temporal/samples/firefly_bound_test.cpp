#include "temporal/samples/firefly_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frame/luminance.h"
#include "tests/reference/firefly_bound.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{40, 24};

// All kinds of pixels: with history, new, unusable, and 5 % with far too much light, which in the
// left half of the image is a change of light.
struct RandomScene {
  explicit RandomScene(Extent extent)
      : expected(random_plane(extent, 2, 0.2f, 1.5f)),
        age(random_plane(extent, 3, 1.0f, 40.0f)),
        samples(random_plane(extent, 4, 1.0f, 3.0f)),
        variance(random_plane(extent, 5, 0.01f, 0.2f)),
        innovation(extent),
        residual(make_planes<3>(extent)) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) fill(x, y);
    }
  }
  void fill(int x, int y) {
    PixelRandom random(7, x, y);
    const bool is_new = random.uniform() < 0.2f, is_usable = random.uniform() < 0.9f;
    const float outliers = 2 * x < age.width() ? 0.5f : 0.05f;
    const float scale = random.uniform() < outliers ? 100.0f : 1.0f;
    if (is_new) expected(x, y) = age(x, y) = 0.0f;
    if (!is_usable) samples(x, y) = 0.0f;
    for (auto& plane : residual) {
      plane(x, y) = is_usable ? scale * random.between(is_new ? 0.0f : -0.3f, 0.5f) : NAN;
    }
    innovation(x, y) = is_new || !is_usable ? NAN : luminance(residual, x, y);
  }
  [[nodiscard]] FireflyInputs in() const { return {expected, age, samples, variance}; }
  [[nodiscard]] reference::FireflyImages images() const {
    reference::FireflyImages images(age.extent());
    images.expected = reference::Image(expected);
    images.age = reference::Image(age);
    images.samples = reference::Image(samples);
    images.variance = reference::Image(variance);
    images.innovation = reference::Image(innovation);
    images.residual = reference::to_double(residual);
    return images;
  }

  Plane<float> expected, age, samples, variance, innovation;
  Planes<3> residual;
};

EL_KERNEL_TEST(CountFireflies, MatchesTheReference) {
  const RandomScene before(extent);
  const reference::FireflyImages images = before.images();
  on_every_target([&] {
    RandomScene scene(extent);
    for_each_tile(TileGrid(extent, kFireflyBlock, kFireflyBlock), [&](const Tile& tile) {
      const FireflyBlock wanted = reference::firefly_block(images, 8.0, tile.x0 / 8, tile.y0 / 8);
      const FireflyBlock found =
          count_fireflies(scene.in(), 8.0f, {scene.residual, scene.innovation}, tile);
      EXPECT_EQ(found.confirmed, wanted.confirmed) << tile.index;
      EXPECT_EQ(found.outliers, wanted.outliers) << tile.index;
      EXPECT_EQ(found.usable, wanted.usable) << tile.index;
      EXPECT_EQ(found.fresh, wanted.fresh) << tile.index;
      EXPECT_NEAR(found.root, wanted.root, 1e-5 * wanted.root) << tile.index;
    });
  });
}

// NaN, the mark of pixels without a prediction, as 1e9.
Plane<float> marked(const Plane<float>& plane) {
  Plane<float> out = plane.clone();
  for (float& value : out.storage()) value = std::isnan(value) ? 1e9f : value;
  return out;
}

EL_KERNEL_TEST(FireflyBound, MatchesTheReference) {
  reference::FireflyImages wanted = RandomScene(extent).images();
  const int wanted_count = reference::bound_fireflies({}, wanted);
  on_every_target([&] {
    RandomScene scene(extent);
    FireflyBound bound(extent, {});
    const FireflyOutputs out{scene.residual, scene.innovation};
    for_each_tile(TileGrid(extent, 64, 16),
                  [&](const Rect& tile) { bound.count(scene.in(), out, tile); });
    EXPECT_EQ(bound.bound(scene.in(), out, [](const Tile&) {}), wanted_count);
    EXPECT_TRUE(planes_near(marked(scene.innovation), marked(reference::rounded(wanted.innovation)),
                            {1e-5, 0.0}));
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_TRUE(planes_near(marked(scene.residual[c]),
                              marked(reference::rounded(wanted.residual[c])), {2e-5, 1e-7}));
    }
  });
  if (extent.pixels() > 10'000) {
    EXPECT_GT(wanted_count, 100);
  }
}

// Gray light of 1 with the right prediction, variance 0.01 and age 4: sigma is sqrt(0.0125 + 0.01)
// = 0.15.
struct Wall {
  Planes<3> residual = make_planes<3>(kExtent);
  Plane<float> innovation{kExtent}, expected{kExtent}, age{kExtent}, samples{kExtent},
      variance{kExtent};
  FireflyBound bound{kExtent, {}};

  Wall() {
    expected.fill(1.0f);
    age.fill(4.0f);
    samples.fill(1.0f);
    variance.fill(0.01f);
  }
  void set(int x, int y, float value) {
    for (auto& plane : residual) plane(x, y) = value - 1.0f;
    innovation(x, y) = value - 1.0f;
  }
  // The residual of a new pixel is all of its light.
  void set_new(int x, int y, float value) {
    for (auto& plane : residual) plane(x, y) = value;
    innovation(x, y) = NAN;
    expected(x, y) = age(x, y) = 0.0f;
  }
  [[nodiscard]] float light(int channel, int x, int y) const {
    return expected(x, y) + residual[static_cast<std::size_t>(channel)](x, y);
  }
  std::int64_t process() {
    const FireflyInputs in{expected, age, samples, variance};
    const FireflyOutputs out{residual, innovation};
    bound.count(in, out, {0, 0, kExtent.width, kExtent.height});
    return bound.bound(in, out, [&](const Tile& block) { changed.push_back(block.index); });
  }
  std::vector<int> changed;
};

// With a history of n frames, the mean moves by 1 / (n + 1) of the sample's distance.
TEST(FireflyBound, SingleOutlierMovesTheMeanByOneDeviation) {
  for (const float n : {1.0f, 4.0f, 16.0f, 60.0f}) {
    Wall p;
    p.age.fill(n);
    p.set(13, 9, 1000.0f);
    EXPECT_EQ(p.process(), 1);
    const float sigma = std::sqrt(0.01f * (1.0f + 1.0f / n) + 0.01f);
    EXPECT_NEAR(p.residual[1](13, 9) / (n + 1.0f), sigma / std::sqrt(n), 1e-4f) << n;
  }
}

TEST(FireflyBound, BoundedPixelKeepsItsHueAndLosesItsInnovation) {
  Wall p;
  p.residual[0](13, 9) = 3000.0f;
  p.residual[1](13, 9) = 1000.0f;
  p.innovation(13, 9) = luminance(p.residual, 13, 9);
  EXPECT_EQ(p.process(), 1);
  EXPECT_TRUE(std::isnan(p.innovation(13, 9)));
  EXPECT_EQ(p.innovation(14, 9), 0.0f);
  EXPECT_EQ(p.changed, std::vector{6});
  // 5 / 2 deviations at age 4.
  const float allowed = 2.5f * std::sqrt(0.01f * 1.25f + 0.01f);
  EXPECT_NEAR(luminance(p.residual, 13, 9), allowed, 1e-4f);
  EXPECT_NEAR(p.residual[0](13, 9) / p.residual[1](13, 9), 3.0f, 1e-4f);
  EXPECT_EQ(p.residual[2](13, 9), 0.0f);
}

TEST(FireflyBound, LightWithinEightDeviationsStays) {
  Wall p;
  p.set(13, 9, 1.0f + 7.9f * 0.15f);
  p.set(20, 9, 1.0f - 7.9f * 0.15f);
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.light(1, 13, 9), 1.0f + 7.9f * 0.15f);
  EXPECT_TRUE(p.changed.empty());
}

TEST(FireflyBound, ChangeOfLightIsNotBounded) {
  Wall p;
  for (int y = 0; y < 24; ++y) {
    for (int x = 8; x < 24; ++x) p.set(x, y, 100.0f);
  }
  EXPECT_EQ(p.process(), 0);
  EXPECT_EQ(p.residual[0](12, 12), 99.0f);
  EXPECT_EQ(p.innovation(12, 12), 99.0f);
}

// Three rows are a twelfth of the pixels in 3 x 3 blocks, but a third of their own block: a moving
// edge of light.
TEST(FireflyBound, AdjacentOutliersAreNotBounded) {
  for (const int rows : {1, 3}) {
    Wall p;
    for (int y = 8; y < 8 + rows; ++y) {
      for (int x = 8; x < 16; ++x) p.set(x, y, 100.0f);
    }
    EXPECT_EQ(p.process(), rows == 1 ? 8 : 0);
  }
}

TEST(FireflyBound, NewPixelsAreBoundedByTheLightAroundThem) {
  Wall p;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) p.set_new(x, y, 1.0f);
  }
  p.set_new(13, 9, 1e6f);
  EXPECT_EQ(p.process(), 1);
  // The surroundings are 576 pixels, one of them with a root of sqrt(1e6) = 1000.
  const float root = (575.0f + 1000.0f) / 576.0f;
  EXPECT_NEAR(p.light(1, 13, 9), 16.0f * root * root, 0.1f);
  EXPECT_EQ(p.light(1, 14, 9), 1.0f);
  EXPECT_NEAR(p.bound.brightness()(1, 1), 16.0f * root * root, 0.1f);
}

TEST(FireflyBound, BrightnessIsBoundedOnlyNearNewPixels) {
  Wall p;
  p.set_new(39, 0, 1.0f);
  EXPECT_EQ(p.process(), 0);
  EXPECT_FLOAT_EQ(p.bound.brightness()(4, 0), 16.0f);
  EXPECT_FLOAT_EQ(p.bound.brightness()(3, 1), 16.0f);
  EXPECT_TRUE(std::isinf(p.bound.brightness()(2, 0)));
}

TEST(FireflyBound, UnusablePixelsDoNotChange) {
  Wall p;
  p.samples(13, 9) = 0.0f;
  p.innovation(13, 9) = p.residual[0](13, 9) = NAN;
  EXPECT_EQ(p.process(), 0);
  EXPECT_TRUE(std::isnan(p.residual[0](13, 9)));
}

TEST(FireflyBound, RejectsBadOptions) {
  EXPECT_THROW(FireflyBound(kExtent, {.deviations = 0.5f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.times = 0.0f}), std::invalid_argument);
  EXPECT_THROW(FireflyBound(kExtent, {.share = 0.0f}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
