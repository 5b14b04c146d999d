#include "spatial/atrous.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/reference/atrous.h"
#include "tests/spatial/atrous_scene.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/walls.h"

namespace eigenlight {
namespace {

using test::AtrousScene;

// Passes that need a margin of one block, and of two; with and without light.
const std::vector<AtrousOptions> kPlanarCases{
    {.passes = 4, .luminance_sigmas = 5.0f},
    {.passes = 5, .luminance_sigmas = 2.0f},
    {.passes = 6, .luminance_sigmas = std::numeric_limits<float>::infinity()}};

void expect_agreement(Extent extent, const AtrousOptions& options, bool looks_back) {
  const AtrousScene before(extent);
  reference::AtrousImage twin(before.color, before.variance);
  for (int i = 0; i < options.passes; ++i) {
    twin = reference::atrous_pass(before.guides, options, twin, 1 << i,
                                  looks_back ? before.earlier_values() : reference::Earlier());
  }
  on_every_target([&] {
    AtrousScene after(extent);
    looks_back ? after.run_with_earlier(options) : (void)after.run(options);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const std::size_t at = twin.index(x, y);
        // A weight multiplies 16 powers of numbers near 1, and there are three passes.
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_NEAR(after.color[c](x, y), twin.values[c][at], 2e-5) << x << ", " << y;
        }
        ASSERT_NEAR(after.variance(x, y), twin.values[3][at], 2e-5 * twin.values[3][at] + 1e-7)
            << x << ", " << y;
      }
    }
  });
}

EL_KERNEL_TEST(Atrous, MatchesTheReference) {
  for (const bool looks_back : {false, true}) {
    expect_agreement(extent, {.passes = 3, .luminance_sigmas = 3.0f}, looks_back);
    expect_agreement(extent, {}, looks_back);
  }
}

// Where all taps lie in one plane, the filter takes the weights of geometry to be 1.
EL_KERNEL_TEST(Atrous, MatchesTheReferenceOnWalls) {
  for (const AtrousOptions& options : kPlanarCases) {
    AtrousScene before(extent);
    before.guides = make_walls(extent, extent.width / 2);
    reference::AtrousImage twin(before.color, before.variance);
    for (int i = 0; i < options.passes; ++i) {
      twin = reference::atrous_pass(before.guides, options, twin, 1 << i);
    }
    on_every_target([&] {
      AtrousScene after(extent);
      after.guides = make_walls(extent, extent.width / 2);
      after.run(options);
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const std::size_t at = twin.index(x, y);
          ASSERT_NEAR(after.color[0](x, y), twin.values[0][at], 2e-4) << x << ", " << y;
          ASSERT_NEAR(after.variance(x, y), twin.values[3][at], 1e-3 * twin.values[3][at]);
        }
      }
    });
  }
}

// Two images of one frame, of which each has quiet tiles of its own.
struct TwoImages {
  explicit TwoImages(Extent extent) : first(extent), second(extent) {
    for (std::size_t c = 0; c < 3; ++c) {
      second.color[c].copy_from(
          random_plane(extent, 11 + static_cast<std::uint32_t>(c), 0.2f, 2.0f));
    }
    second.variance.copy_from(random_plane(extent, 15, 0.05f, 0.5f));
    const int half = extent.width / 2;
    fill_rect(first.variance, {0, 0, half, extent.height}, 1e-9f);
    fill_rect(second.variance, {half / 2, 0, extent.width, (extent.height + 1) / 2}, 1e-9f);
  }
  AtrousScene first, second;
};

EL_KERNEL_TEST(Atrous, FiltersSeveralImagesAsItFiltersEach) {
  constexpr float kQuiet = 1e-5f;
  // Planes are looked for where any image needs them, so they are turned off here.
  const AtrousOptions options{.passes = 4, .skip_planar = false};
  on_every_target([&] {
    for (const bool looks_back : {false, true}) {
      TwoImages alone(extent), together(extent);
      std::int64_t skipped = 0;
      for (AtrousScene* scene : {&alone.first, &alone.second}) {
        Atrous atrous(extent, options);
        skipped += atrous.process(scene->guides, kQuiet, scene->color, scene->variance,
                                  looks_back ? &scene->earlier : nullptr);
      }
      const auto image = [&](AtrousScene& scene) {
        return AtrousImage{scene.color, scene.variance, looks_back ? &scene.earlier : nullptr};
      };
      Atrous atrous(extent, options, 2);
      const std::array images{image(together.first), image(together.second)};
      EXPECT_EQ(atrous.process(together.first.guides, kQuiet, images), skipped);
      EXPECT_TRUE(planes_equal(together.first.color, alone.first.color));
      EXPECT_TRUE(planes_equal(together.second.color, alone.second.color));
      EXPECT_TRUE(planes_equal(together.first.variance, alone.first.variance));
      EXPECT_TRUE(planes_equal(together.second.variance, alone.second.variance));
    }
  });
}

TEST(Atrous, CountsPlanarPixels) {
  const Extent extent{128, 48};
  AtrousScene scene(extent);
  scene.guides = make_walls(extent, 64);
  for (const bool skip : {true, false}) {
    Atrous atrous(extent, {.skip_planar = skip});
    atrous.process(scene.guides, 0.0f, scene.color, scene.variance);
    EXPECT_EQ(atrous.planar_pixels(), skip ? 14 * 8 * 48 : 0);
  }
}

TEST(Atrous, FiltersSelectedTilesOnly) {
  const Extent extent{128, 32};  // 2 x 2 tiles of 64 x 16
  AtrousScene all(extent), some(extent);
  const AtrousScene before(extent);
  Atrous atrous(extent, {.passes = 1});
  PerTile<std::uint8_t> wanted(stage_tiles(extent));
  wanted[1] = 1;
  atrous.process(std::array{AtrousPart{some.guides, wanted, some.color, some.variance}});
  all.run({.passes = 1});
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 128; ++x) {
      const bool filtered = x >= 64 && y < 16;
      ASSERT_EQ(some.color[1](x, y), (filtered ? all : before).color[1](x, y)) << x << ", " << y;
    }
  }
  const PerTile<std::uint8_t> others(stage_tiles({128, 48}));
  const AtrousPart part{some.guides, others, some.color, some.variance};
  EXPECT_THROW(atrous.process(std::array{part}), std::invalid_argument);
}

TEST(Atrous, ConstantLightStaysConstant) {
  for (const Extent extent : kSweepExtents) {
    AtrousScene scene(extent, false);
    for (auto& plane : scene.color) plane.fill(0.7f);
    scene.run();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) ASSERT_NEAR(scene.color[1](x, y), 0.7f, 2e-6f);
    }
  }
}

TEST(Atrous, KeepsEnergyAndLowersVarianceOnAWall) {
  AtrousScene scene = AtrousScene::wall({191, 107});
  scene.variance.fill(0.3f);
  for (auto& plane : scene.color) plane.copy_from(random_plane({191, 107}, 3, 0.0f, 2.0f));
  const auto moments = [&] {
    double sum = 0.0, square = 0.0;
    for (int y = 0; y < 107; ++y) {
      for (int x = 0; x < 191; ++x) {
        const double v = scene.color[0](x, y);
        sum += v;
        square += v * v;
      }
    }
    sum /= 191.0 * 107.0;
    return std::array<double, 2>{sum, square / (191.0 * 107.0) - sum * sum};
  };
  const auto before = moments();
  scene.run({.passes = 4, .luminance_sigmas = 7.0f});
  const auto after = moments();
  EXPECT_NEAR(after[0], before[0], 0.01);
  EXPECT_LT(after[1], before[1] / 100.0);
  // From the second pass on neighbors share noise. The estimate ignores that, so it is a tenth of
  // the true variance here.
  EXPECT_LT(scene.variance(95, 53), after[1] * 1.5);
  EXPECT_GT(scene.variance(95, 53), after[1] / 16.0);
}

TEST(Atrous, BlackStaysBlackAndFinite) {
  AtrousScene scene = AtrousScene::wall({65, 17});
  for (auto& plane : scene.color) plane.fill(0.0f);
  for (const float variance : {0.0f, 1.0f}) {
    scene.variance.fill(variance);
    scene.run({}, 1e-5f);
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 65; ++x) ASSERT_EQ(scene.color[2](x, y), 0.0f);
    }
    EXPECT_TRUE(std::isfinite(scene.variance(64, 16)));
  }
}

TEST(Atrous, SkipsQuietTiles) {
  const Extent extent{128, 32};  // 2 x 2 tiles of 64 x 16
  AtrousScene scene = AtrousScene::wall(extent);
  for (auto& plane : scene.color) plane.copy_from(random_plane(extent, 3, 0.5f, 1.5f));
  scene.variance.fill(1e-7f);
  scene.variance(100, 20) = 0.1f;  // the last tile is not quiet
  scene.guides.surface.id(3, 3) = 0;
  const Planes<3> before{scene.color[0].clone(), scene.color[1].clone(), scene.color[2].clone()};
  EXPECT_EQ(scene.run({}, 1e-5f), 3 * 64 * 16 - 1);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 128; ++x) ASSERT_EQ(scene.color[0](x, y), before[0](x, y));
  }
  EXPECT_NE(scene.color[0](100, 20), before[0](100, 20));
}

TEST(Atrous, FiltersTilesWithANoisyPixel) {
  AtrousScene scene = AtrousScene::wall({128, 32});
  scene.variance.fill(0.1f);
  EXPECT_EQ(scene.run({}, 1e-5f), 0);
}

TEST(Atrous, ThreadCountDoesNotChangeTheBits) {
  const Extent extent{191, 107};
  AtrousScene one(extent), three(extent);
  set_thread_count(1);
  one.run();
  set_thread_count(3);
  three.run();
  set_thread_count(0);
  EXPECT_TRUE(planes_equal(one.color, three.color));
  EXPECT_TRUE(planes_equal(one.variance, three.variance));
}

TEST(Atrous, RejectsOtherExtentsAndBadOptions) {
  AtrousScene scene({64, 16});
  Atrous other({65, 16}, {});
  EXPECT_THROW((void)other.process(scene.guides, 0.0f, scene.color, scene.variance),
               std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.passes = 0}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.passes = 7}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.luminance_sigmas = 0.0f}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.plane_distance = 1.5f}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.earlier_sigmas = 0.0f}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.earlier_share = 1.5f}), std::invalid_argument);
  Atrous same({64, 16}, {});
  const Plane<float> earlier({64, 17});
  EXPECT_THROW((void)same.process(scene.guides, 0.0f, scene.color, scene.variance, &earlier),
               std::invalid_argument);
  EXPECT_THROW(Atrous({0, 8}, {}), std::invalid_argument);
}

TEST(Atrous, RejectsImagesThatDoNotFitTogether) {
  AtrousScene scene({64, 16});
  EXPECT_THROW(Atrous({8, 8}, {}, 0), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {}, Atrous::kMostImages + 1), std::invalid_argument);
  Atrous one({64, 16}, {}), two({64, 16}, {}, 2);
  const AtrousImage plain{scene.color, scene.variance};
  const AtrousImage with_earlier{scene.color, scene.variance, &scene.earlier};
  EXPECT_THROW((void)one.process(scene.guides, 0.0f, std::array{plain, plain}),
               std::invalid_argument);
  EXPECT_THROW((void)two.process(scene.guides, 0.0f, std::array{plain, with_earlier}),
               std::invalid_argument);
  EXPECT_THROW((void)two.process(scene.guides, 0.0f, std::span<const AtrousImage>()),
               std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
