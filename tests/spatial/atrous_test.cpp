#include "spatial/atrous.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reference/atrous.h"
#include "tests/support/compare.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"
#include "tests/support/walls.h"

namespace eigenlight {
namespace {

struct Scene {
  explicit Scene(Extent extent, bool sky = true)
      : guides(make_random_frame({.extent = extent, .sky = sky, .non_finite = false}, 2)),
        color(make_planes<3>(extent)),
        variance(random_plane(extent, 5, 0.01f, 0.3f)),
        earlier(random_plane(extent, 6, 0.3f, 1.5f)) {
    copy_planes(guides.lights[0].radiance, color);
    forget_some();
  }
  // One wall, seen straight.
  static Scene wall(Extent extent) {
    Scene scene(extent, false);
    scene.guides.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
    scene.guides.surface.id.fill(1);
    scene.guides.surface.depth.fill(4.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      scene.guides.surface.normal[c].fill(c == 2 ? -1.0f : 0.0f);
    }
    return scene;
  }
  std::int64_t run(const AtrousOptions& options = {}, float quiet = 0.0f) {
    Atrous atrous(variance.extent(), options);
    return atrous.process(guides, quiet, color, variance);
  }
  // The earlier picture is not known of one pixel in thirteen.
  void forget_some() {
    for (int y = 0; y < earlier.height(); ++y) {
      for (int x = 0; x < earlier.width(); ++x) {
        if ((x + 5 * y) % 13 == 0) earlier(x, y) = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  void run_with_earlier(const AtrousOptions& options = {}) {
    Atrous atrous(variance.extent(), options);
    atrous.process(guides, 0.0f, color, variance, &earlier);
  }
  [[nodiscard]] reference::Earlier earlier_values() const {
    reference::Earlier values;
    for (int y = 0; y < earlier.height(); ++y) {
      values.insert(values.end(), earlier.row(y), earlier.row(y) + earlier.width());
    }
    return values;
  }
  // Fills color: `left` of the middle column, and right of it.
  void set_halves(float left, float right) {
    for (auto& plane : color) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) {
          plane(x, y) = x < plane.width() / 2 ? left : right;
        }
      }
    }
  }
  Frame guides;
  Planes<3> color;
  Plane<float> variance, earlier;
};

// Passes that need a margin of one block, and of two; with and without light.
const std::vector<AtrousOptions> kPlanarCases{
    {.passes = 4, .radius = 1, .luminance_sigmas = 5.0f},
    {.passes = 4, .radius = 2, .luminance_sigmas = 2.0f},
    {.passes = 6, .radius = 1, .luminance_sigmas = std::numeric_limits<float>::infinity()}};

void expect_agreement(Extent extent, const AtrousOptions& options, bool looks_back) {
  const Scene before(extent);
  reference::AtrousImage twin(before.color, before.variance);
  for (int i = 0; i < options.passes; ++i) {
    twin = reference::atrous_pass(before.guides, options, twin, 1 << i,
                                  looks_back ? before.earlier_values() : reference::Earlier());
  }
  for_each_target([&] {
    Scene after(extent);
    looks_back ? after.run_with_earlier(options) : (void)after.run(options);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const std::size_t at = twin.index(x, y);
        // A weight is a product of 16 powers of numbers near 1, three passes deep.
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_NEAR(after.color[c](x, y), twin.values[c][at], 2e-5) << x << ", " << y;
        }
        ASSERT_NEAR(after.variance(x, y), twin.values[3][at], 2e-5 * twin.values[3][at] + 1e-7)
            << x << ", " << y;
      }
    }
  });
}

TEST(Atrous, AgreesWithTheTwinOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    for (const bool looks_back : {false, true}) {
      expect_agreement(extent, {.passes = 3}, looks_back);
      expect_agreement(extent, {.passes = 3, .radius = 1}, looks_back);
    }
  }
}

// Where all taps lie in one plane, weights of geometry are taken to be 1.
TEST(Atrous, AgreesWithTheTwinOnWallsOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    for (const AtrousOptions& options : kPlanarCases) {
      Scene before(extent);
      before.guides = make_walls(extent, extent.width / 2);
      reference::AtrousImage twin(before.color, before.variance);
      for (int i = 0; i < options.passes; ++i) {
        twin = reference::atrous_pass(before.guides, options, twin, 1 << i);
      }
      for_each_target([&] {
        Scene after(extent);
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
}

TEST(Atrous, CountsPixelsThatLieInOnePlaneWithTheirTaps) {
  const Extent extent{128, 48};
  Scene scene(extent);
  scene.guides = make_walls(extent, 64);
  for (const bool skip : {true, false}) {
    Atrous atrous(extent, {.skip_planar = skip});
    atrous.process(scene.guides, 0.0f, scene.color, scene.variance);
    EXPECT_EQ(atrous.planar_pixels(), skip ? 14 * 8 * 48 : 0);
  }
}

TEST(Atrous, FiltersTheTilesThatAreWantedAndCopiesTheOthers) {
  const Extent extent{128, 32};  // 2 x 2 tiles of 64 x 16
  Scene all(extent), some(extent);
  const Scene before(extent);
  Atrous atrous(extent, {.passes = 1});
  const std::vector<std::uint8_t> wanted{0, 1, 0, 0};
  atrous.process(some.guides, wanted, some.color, some.variance);
  all.run({.passes = 1});
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 128; ++x) {
      const bool filtered = x >= 64 && y < 16;
      ASSERT_EQ(some.color[1](x, y), (filtered ? all : before).color[1](x, y)) << x << ", " << y;
    }
  }
  EXPECT_THROW(atrous.process(some.guides, std::vector<std::uint8_t>(3), some.color, some.variance),
               std::invalid_argument);
}

TEST(Atrous, FlatLightStaysFlat) {
  for (const Extent extent : kSweepExtents) {
    Scene scene(extent, false);
    for (auto& plane : scene.color) plane.fill(0.7f);
    scene.run();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) ASSERT_NEAR(scene.color[1](x, y), 0.7f, 2e-6f);
    }
  }
}

TEST(Atrous, KeepsEnergyAndLowersVarianceOnAWall) {
  Scene scene = Scene::wall({191, 107});
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
  scene.run();
  const auto after = moments();
  EXPECT_NEAR(after[0], before[0], 0.01);
  EXPECT_LT(after[1], before[1] / 20.0);
  // It never claims more variance than there is. From pass two on neighbors share noise, which the
  // formula does not know: it claims a thirtieth here.
  EXPECT_LT(scene.variance(95, 53), after[1] * 1.5);
  EXPECT_GT(scene.variance(95, 53), after[1] / 64.0);
}

// One kind of edge at a time, everything else flat: the two sides must not mix.
class AtrousEdge : public ::testing::Test {
 protected:
  AtrousEdge() : scene_(Scene::wall({64, 16})) {
    scene_.variance.fill(1e4f);  // luminance says nothing
    scene_.set_halves(1.0f, 3.0f);
  }
  void for_right_half(const std::function<void(int x, int y)>& visit) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 32; x < 64; ++x) visit(x, y);
    }
  }
  void expect_kept() {
    for (int x = 0; x < 64; ++x) {
      ASSERT_NEAR(scene_.color[0](x, 8), x < 32 ? 1.0f : 3.0f, 1e-3f) << x;
    }
  }
  Scene scene_;
};

TEST_F(AtrousEdge, IsBlurredWhenNothingHolds) {
  scene_.run();
  EXPECT_GT(scene_.color[0](31, 8), 1.5f);
  EXPECT_LT(scene_.color[0](32, 8), 2.5f);
}

TEST_F(AtrousEdge, OfNormalsHolds) {
  for_right_half([&](int x, int y) {
    scene_.guides.surface.normal[0](x, y) = 0.6f;
    scene_.guides.surface.normal[2](x, y) = -0.8f;
  });
  // Planes that go on at an angle are far off soon, but close to the edge only normals tell.
  scene_.run({.plane_distance = 1.0f});
  expect_kept();
}

TEST_F(AtrousEdge, OfDepthHolds) {
  for_right_half([&](int x, int y) { scene_.guides.surface.depth(x, y) = 5.0f; });
  scene_.run();
  expect_kept();
}

TEST_F(AtrousEdge, OfLuminanceHolds) {
  scene_.variance.fill(1e-3f);  // 3 sigma: 0.09
  scene_.run();
  expect_kept();
}

TEST_F(AtrousEdge, OfAnEarlierPictureHolds) {
  scene_.variance.fill(0.5f);  // 3 sigma: 2.1, of own light alone it would be blurred
  scene_.run();
  EXPECT_GT(scene_.color[0](31, 8), 1.1f);
  scene_.set_halves(1.0f, 3.0f);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 64; ++x) scene_.earlier(x, y) = x < 32 ? 1.0f : 30.0f;
  }
  scene_.variance.fill(0.5f);
  scene_.run_with_earlier();
  expect_kept();
}

TEST_F(AtrousEdge, OfSkyHoldsAndSkyKeepsItsValue) {
  for_right_half([&](int x, int y) {
    scene_.guides.surface.id(x, y) = 0;
    scene_.guides.surface.depth(x, y) = std::numeric_limits<float>::infinity();
    for (auto& normal : scene_.guides.surface.normal) normal(x, y) = 0.0f;
  });
  for_each_target([&] {
    scene_.run();
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 64; ++x) {
        ASSERT_TRUE(std::isfinite(scene_.color[0](x, y)));
        ASSERT_TRUE(std::isfinite(scene_.variance(x, y)));
      }
    }
    expect_kept();
    EXPECT_EQ(scene_.color[0](40, 8), 3.0f);
    EXPECT_EQ(scene_.variance(40, 8), 1e4f);
  });
}

TEST(Atrous, BlackStaysBlackAndFinite) {
  Scene scene = Scene::wall({65, 17});
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

TEST(Atrous, SkipsQuietTilesAndCountsTheirSurface) {
  const Extent extent{128, 32};  // 2 x 2 tiles of 64 x 16
  Scene scene = Scene::wall(extent);
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

TEST(Atrous, SkipsNothingWhereAnyVarianceIsAboveTheBound) {
  Scene scene = Scene::wall({128, 32});
  scene.variance.fill(0.1f);
  EXPECT_EQ(scene.run({}, 1e-5f), 0);
}

TEST(Atrous, GivesTheSameBitsForAnyNumberOfThreads) {
  const Extent extent{191, 107};
  Scene one(extent), three(extent);
  set_thread_count(1);
  one.run();
  set_thread_count(3);
  three.run();
  set_thread_count(0);
  EXPECT_TRUE(planes_equal(one.color, three.color));
  EXPECT_TRUE(planes_equal(one.variance, three.variance));
}

TEST(Atrous, RefusesOtherExtentsAndBadOptions) {
  Scene scene({64, 16});
  Atrous other({65, 16}, {});
  EXPECT_THROW((void)other.process(scene.guides, 0.0f, scene.color, scene.variance),
               std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.passes = 0}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.passes = 7}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.radius = 0}), std::invalid_argument);
  EXPECT_THROW(Atrous({8, 8}, {.radius = 3}), std::invalid_argument);
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

}  // namespace
}  // namespace eigenlight
