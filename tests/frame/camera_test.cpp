#include "frame/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace eigenlight {
namespace {

constexpr Extent kExtent{191, 107};

void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "coordinate " << c;
}

Camera tilted() { return look_at({1, 2, 3}, {-4, 0.5f, 9}, {0.1f, 1, 0}, 60.0f, kExtent); }

TEST(Camera, PixelsAndPointsRoundTrip) {
  const Camera camera = tilted();
  for (const glm::vec2 pixel : {glm::vec2(0.5f, 0.5f), glm::vec2(190.5f, 106.5f),
                                glm::vec2(95.5f, 53.5f), glm::vec2(20.25f, 80.75f)}) {
    for (const float depth : {0.1f, 5.0f, 1000.0f}) {
      const glm::vec3 view = camera.pixel_to_view(pixel) * depth;
      EXPECT_FLOAT_EQ(view.z, depth);
      const glm::vec2 back = camera.view_to_pixel(camera.to_view(camera.to_world(view)));
      EXPECT_NEAR(back.x, pixel.x, 0.02f);  // 1 ulp of the eye over the smallest depth: 0.01 pixels
      EXPECT_NEAR(back.y, pixel.y, 0.02f);
    }
  }
}

TEST(Camera, ViewTransformIsARotation) {
  const glm::mat3 m = tilted().world_to_view;
  const glm::mat3 product = m * glm::transpose(m);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1.0f : 0.0f, 1e-6f);
  }
  EXPECT_NEAR(glm::determinant(m), 1.0f, 1e-6f);
}

TEST(Camera, TargetIsInTheImageCenter) {
  const Camera camera = tilted();
  const glm::vec3 view = camera.to_view({-4, 0.5f, 9});
  EXPECT_GT(view.z, 0.0f);
  const glm::vec2 pixel = camera.view_to_pixel(view);
  EXPECT_NEAR(pixel.x, 95.5f, 1e-3f);
  EXPECT_NEAR(pixel.y, 53.5f, 1e-3f);
}

TEST(Camera, ImageIsUprightAndNotMirrored) {
  const Camera camera = look_at({0, 0, 0}, {0, 0, -5}, {0, 1, 0}, 60.0f, kExtent);
  const glm::vec2 above = camera.view_to_pixel(camera.to_view({0, 1, -5}));
  EXPECT_LT(above.y, camera.center.y);
  EXPECT_NEAR(above.x, camera.center.x, 1e-4f);
  const glm::vec2 right = camera.view_to_pixel(camera.to_view({1, 0, -5}));
  EXPECT_GT(right.x, camera.center.x);
  EXPECT_NEAR(right.y, camera.center.y, 1e-4f);
}

TEST(Camera, FieldOfViewSpansTheHeight) {
  const Camera camera = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 50.0f, kExtent);
  const float half = std::tan(25.0f * std::numbers::pi_v<float> / 180.0f);
  EXPECT_NEAR(camera.view_to_pixel(camera.to_view({0, half, -1})).y, 0.0f, 1e-4f);
  EXPECT_NEAR(camera.view_to_pixel(camera.to_view({0, -half, -1})).y, 107.0f, 1e-4f);
}

TEST(Camera, UpVectorParallelToTheViewIsReplaced) {
  for (const glm::vec3 target : {glm::vec3(0, 5, 0), glm::vec3(0, -5, 0), glm::vec3(3, 0, 0)}) {
    for (const glm::vec3 up : {target, -target, glm::vec3(0.0f)}) {
      const Camera camera = look_at({0, 0, 0}, target, up, 60.0f, kExtent);
      EXPECT_NEAR(glm::determinant(camera.world_to_view), 1.0f, 1e-5f);
      expect_near(camera.to_view(target), {0, 0, glm::length(target)}, 1e-5f);
    }
  }
}

TEST(Camera, RejectsInvalidViews) {
  EXPECT_THROW((void)look_at({1, 1, 1}, {1, 1, 1}, {0, 1, 0}, 60, kExtent), std::invalid_argument);
  EXPECT_THROW((void)look_at({0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 0, kExtent), std::invalid_argument);
  EXPECT_THROW((void)look_at({0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 180, kExtent), std::invalid_argument);
  EXPECT_THROW((void)look_at({0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 60, {0, 4}), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
