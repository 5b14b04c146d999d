// Planes that guide rays fill.
#include "render/paths/gbuffer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using test::add_floor;
using test::add_material;
using test::at;
using test::render_still;

RenderOptions cheap(Extent extent) {
  RenderOptions o;
  o.extent = extent;
  o.spp = o.direct_spp = 1;
  return o;
}

TEST(GBuffer, DepthIsMeasuredAlongTheViewAxis) {
  Scene scene;
  test::add_quad(scene, add_material(scene, {0.2f, 0.4f, 0.6f}),
                 {glm::vec3(-9, -9, 5), glm::vec3(18, 0, 0), glm::vec3(0, 18, 0)});
  const Extent extent{12, 8};
  const Camera camera = look_at({0, 0, 1}, {0, 0, 2}, {0, 1, 0}, 70.0f, extent);
  const Frame frame = render_still(scene, camera, cheap(extent));
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      EXPECT_FLOAT_EQ(frame.surface.depth(x, y), 4.0f);  // the distance along the ray is longer
      EXPECT_EQ(frame.surface.id(x, y), 1U);
      EXPECT_FLOAT_EQ(at(frame.surface.albedo, 2, x, y), 0.6f);
      EXPECT_FLOAT_EQ(at(frame.surface.normal, 2, x, y), -1.0f);  // faces the camera
      glm::vec3 position;
      for (int c = 0; c < 3; ++c) position[c] = at(frame.position, c, x, y);
      const glm::vec2 pixel = camera.view_to_pixel(camera.to_view(position));
      EXPECT_NEAR(pixel.x, static_cast<float>(x) + 0.5f, 1e-4f);
      EXPECT_NEAR(pixel.y, static_cast<float>(y) + 0.5f, 1e-4f);
    }
  }
}

TEST(GBuffer, VertexNormalsAreInterpolatedUnlessTheyFaceAway) {
  Scene scene;
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  const glm::vec3 leaning = glm::normalize(glm::vec3(0.3f, 1, 0));
  const Extent extent{2, 2};
  const Camera camera = look_at({0, 1, 0}, {0, 0, 0}, {0, 0, 1}, 30.0f, extent);
  scene.meshes[0].normals.assign(4, leaning);
  const Frame smooth = render_still(scene, camera, cheap(extent));
  EXPECT_NEAR(at(smooth.surface.normal, 0, 0, 0), leaning.x, 1e-4f);
  EXPECT_NEAR(at(smooth.surface.normal, 1, 0, 0), leaning.y, 1e-4f);
  scene.meshes[0].normals.assign(4, -leaning);  // the other side of the same surface
  EXPECT_NEAR(at(render_still(scene, camera, cheap(extent)).surface.normal, 1, 0, 0), leaning.y,
              1e-4f);
  scene.meshes[0].normals.assign(4, glm::vec3(0.0f));
  EXPECT_FLOAT_EQ(at(render_still(scene, camera, cheap(extent)).surface.normal, 1, 0, 0), 1.0f);
}

TEST(GBuffer, LightShapesHaveIdsAfterTheInstances) {
  Scene scene;
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  scene.lights.rects = {{{0, 0, 3}, {0, 9, 0}, {9, 0, 0}, {1, 2, 3}}};  // faces -z
  scene.lights.spheres = {{{0, 1, 2}, 0.5f, {4, 5, 6}}};
  const Extent extent{9, 9};
  const Frame frame =
      render_still(scene, look_at({0, 1, 0}, {0, 1, 1}, {0, 1, 0}, 60.0f, extent), cheap(extent));
  EXPECT_EQ(frame.surface.id(4, 4), 3U);  // the sphere, in front of the rectangle
  EXPECT_FLOAT_EQ(frame.surface.depth(4, 4), 1.5f);
  EXPECT_FLOAT_EQ(at(frame.emission, 1, 4, 4), 5.0f);
  EXPECT_EQ(frame.surface.id(0, 0), 2U);
  EXPECT_FLOAT_EQ(at(frame.emission, 1, 0, 0), 2.0f);
  EXPECT_EQ(at(frame.surface.albedo, 0, 4, 4), 0.0f);
  EXPECT_EQ(at(frame.direct, 0, 4, 4), 0.0f);
  EXPECT_FLOAT_EQ(frame.motion[0](4, 4), 0.0f);
}

TEST(GBuffer, MotionFollowsALightShape) {
  Scene scene;
  const Extent extent{9, 9};
  const Camera camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
  const auto lights = [](int frame) {
    Lights l;
    l.spheres = {{{0.1f * static_cast<float>(frame), 0, 3}, 1.0f, glm::vec3(1.0f)}};
    return l;
  };
  const test::FunctionAnimation animation([&](int frame) {
    return SceneState{camera, lights(frame), {}};
  });
  LiveSource source(scene, animation, cheap(extent), {1});
  Frame frame;
  ASSERT_TRUE(source.next(frame));
  ASSERT_EQ(frame.surface.id(4, 4), 1U);
  const float depth = frame.surface.depth(4, 4);
  // World x may point to the left or right in the image; the distance is the same.
  EXPECT_NEAR(std::abs(frame.motion[0](4, 4)), 0.1f * camera.focal / depth, 1e-3f);
  EXPECT_NEAR(frame.previous_depth(4, 4), depth, 1e-5f);
}

TEST(GBuffer, SkyHasNoSurface) {
  Scene scene;
  scene.lights.sky = {1, 2, 3};
  const Extent extent{3, 3};
  const Frame frame =
      render_still(scene, look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent), cheap(extent));
  EXPECT_EQ(frame.surface.depth(1, 1), std::numeric_limits<float>::infinity());
  EXPECT_EQ(frame.surface.id(1, 1), 0U);
  EXPECT_EQ(at(frame.surface.normal, 0, 1, 1), 0.0f);
  EXPECT_EQ(at(frame.lights[0].radiance, 0, 1, 1), 0.0f);
  EXPECT_EQ(at(frame.emission, 2, 1, 1), 3.0f);
  EXPECT_EQ(frame.rays, 9);  // guide rays only
}

// A distant fine checkerboard is gray in every pixel.
TEST(GBuffer, TexturesAreFilteredOverThePixel) {
  Scene scene;
  const int board = add_material(scene, glm::vec3(1.0f));
  scene.materials[0].texture = 0;
  Texture texture{"board", {64, 64}, std::vector<std::uint8_t>(4 * 64 * 64, 255)};
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    const bool black = (i % 64 + i / 64) % 2 == 0;
    for (std::size_t c = 0; c < 3; ++c) texture.rgba[4 * i + c] = black ? 0 : 255;
  }
  scene.textures.push_back(texture);
  test::add_quad(scene, board, {glm::vec3(-9, -9, 5), glm::vec3(18, 0, 0), glm::vec3(0, 18, 0)});
  const Extent extent{8, 8};
  const Frame frame =
      render_still(scene, look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90.0f, extent), cheap(extent));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_NEAR(at(frame.surface.albedo, 0, x, y), 0.5f, 0.01f);
  }
}

}  // namespace
}  // namespace eigenlight
