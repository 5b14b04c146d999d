#include "render/scene/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "frame/random.h"
#include "render/scene/mesh_builder.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Many copies of the cube [-1, 1]^3 in a row, for a hierarchy of several levels.
Scene cubes(int count) {
  Scene scene;
  MeshBuilder builder;
  builder.box(glm::vec3(-1.0f), glm::vec3(1.0f));
  scene.meshes.push_back(builder.take("cube", 0));
  scene.materials.emplace_back();
  for (int i = 0; i < count; ++i) {
    glm::mat4 move(1.0f);
    move[3] = glm::vec4(10.0f * static_cast<float>(i), 0.0f, 0.0f, 1.0f);
    scene.instances.push_back({0, move});
  }
  return scene;
}

float distance_to_cube(const glm::vec3& p) {
  const glm::vec3 d = abs(p) - 1.0f;
  const float inside = std::max({d.x, d.y, d.z});
  return inside < 0.0f ? -inside : length(max(d, glm::vec3(0.0f)));
}

TEST(Clearance, DistanceIsMeasuredToTheNearestCube) {
  const Clearance clearance(cubes(40));
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto random = [i](std::uint32_t k) { return to_unit(hash_key(1U, i, k)); };
    const glm::vec3 p(-5.0f + 400.0f * random(0), -4.0f + 8.0f * random(1),
                      -4.0f + 8.0f * random(2));
    float nearest = kInfinity;
    for (int c = 0; c < 40; ++c) {
      nearest =
          std::min(nearest, distance_to_cube(p - glm::vec3(10.0f * static_cast<float>(c), 0, 0)));
    }
    ASSERT_NEAR(clearance.distance(p, kInfinity), nearest, 1e-4f * (1.0f + nearest)) << i;
  }
}

TEST(Clearance, LimitBoundsTheDistance) {
  EXPECT_EQ(Clearance(cubes(1)).distance({6, 0, 0}, 2.0f), 2.0f);
}

TEST(Clearance, TrianglesWithoutAreaAreSurfaces) {
  Scene scene = cubes(1);
  scene.meshes[0].positions = {{3, 0, 0}, {4, 0, 0}, {5, 0, 0}};
  scene.meshes[0].triangles = {{0, 1, 2}};
  EXPECT_NEAR(Clearance(scene).distance({4.5f, 2, 0}, kInfinity), 2.0f, 1e-5f);
}

TEST(Clearance, LightShapesAreSurfaces) {
  Scene scene = cubes(1);
  scene.lights.rects.push_back({{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, glm::vec3(1.0f)});
  scene.lights.spheres.push_back({{0, -9, 0}, 2.0f, glm::vec3(1.0f)});
  const Clearance clearance(scene);
  EXPECT_NEAR(clearance.distance({0.3f, 4.5f, 0.2f}, kInfinity), 0.5f, 1e-5f);
  EXPECT_NEAR(clearance.distance({0, -6, 0}, kInfinity), 1.0f, 1e-5f);
  EXPECT_LT(clearance.distance({0, -9, 0}, kInfinity), 0.0f);
}

// A cone of slope s that points straight at a wall at distance d touches it at d / (1 + s).
TEST(Clearance, ConeStopsAtItsFirstContact) {
  const Clearance clearance(cubes(1));
  for (const float slope : {0.0f, 0.05f, 0.3f}) {
    const float travel = clearance.free_travel({{5, 0, 0}, {-1, 0, 0}, slope}, kInfinity);
    EXPECT_LE(travel, 4.0f / (1.0f + slope) * (1.0f + 1e-5f));
    EXPECT_GE(travel, 4.0f / (1.0f + slope) * 0.997f);
  }
  EXPECT_EQ(clearance.free_travel({{5, 0, 0}, {1, 0, 0}, 0.1f}, 30.0f), 30.0f);
  // The cone passes the cube and stops where its radius equals the distance to the cube.
  const float aside = clearance.free_travel({{0, 3, 0}, {1, 0, 0}, 1.0f}, kInfinity);
  EXPECT_NEAR(clearance.distance({aside, 3, 0}, kInfinity), aside, 0.01f);
}

}  // namespace
}  // namespace eigenlight
