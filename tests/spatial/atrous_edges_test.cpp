// Edges that the a-trous filter keeps.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/spatial/atrous_scene.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

using test::AtrousScene;

// One kind of edge at a time, everything else flat: the two sides must not mix.
class AtrousEdge : public ::testing::Test {
 protected:
  AtrousEdge() : scene_(AtrousScene::wall({64, 16})) {
    scene_.variance.fill(1e4f);  // differences of luminance do not count
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
  AtrousScene scene_;
};

TEST_F(AtrousEdge, StepIsBlurredWithoutGuides) {
  scene_.run();
  EXPECT_GT(scene_.color[0](31, 8), 1.5f);
  EXPECT_LT(scene_.color[0](32, 8), 2.5f);
}

TEST_F(AtrousEdge, NormalEdgeIsKept) {
  for_right_half([&](int x, int y) {
    scene_.guides.surface.normal[0](x, y) = 0.6f;
    scene_.guides.surface.normal[2](x, y) = -0.8f;
  });
  // Close to the edge, planes at an angle differ in their normals only.
  scene_.run({.plane_distance = 1.0f});
  expect_kept();
}

TEST_F(AtrousEdge, DepthEdgeIsKept) {
  for_right_half([&](int x, int y) { scene_.guides.surface.depth(x, y) = 5.0f; });
  scene_.run();
  expect_kept();
}

TEST_F(AtrousEdge, LuminanceEdgeIsKept) {
  scene_.variance.fill(1e-3f);  // 7 sigma: 0.22
  scene_.run();
  expect_kept();
}

TEST_F(AtrousEdge, EdgeOfTheEarlierPictureIsKept) {
  scene_.variance.fill(0.5f);  // 7 sigma: 4.9, own light alone would blur the edge
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

TEST_F(AtrousEdge, SkyEdgeIsKept) {
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

}  // namespace
}  // namespace eigenlight
