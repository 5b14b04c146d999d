#include "render/rays/embree_scene.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

using test::add_floor;
using test::add_material;

const glm::vec3 kDown(0, -1, 0);

/// An image whose left half is opaque and whose right half is transparent.
Texture half_clear() {
  Texture texture{"half", {8, 8}, std::vector<std::uint8_t>(256, 255)};
  for (std::size_t i = 0; i < 64; ++i) {
    if (i % 8 >= 4) texture.rgba[4 * i + 3] = 0;
  }
  return texture;
}

TEST(EmbreeScene, IntersectReturnsTheNearestTriangle) {
  Scene scene;
  const int material = add_material(scene, glm::vec3(0.5f));
  add_floor(scene, material, 1.0f, 0.0f);
  add_floor(scene, material, 1.0f, 0.5f);
  const EmbreeScene geometry(scene);
  const auto hit = geometry.intersect({{0.3f, 2, 0.2f}, kDown});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->instance, 1U);
  EXPECT_FLOAT_EQ(hit->t, 1.5f);
  EXPECT_FLOAT_EQ(std::abs(hit->normal.y), 1.0f);
  EXPECT_FALSE(geometry.intersect({{3, 2, 0}, kDown}));
  EXPECT_TRUE(geometry.occluded({{0.3f, 2, 0.2f}, kDown}));
  EXPECT_FALSE(geometry.occluded({{0.3f, 2, 0.2f}, kDown, 0.0f, 1.4f}));
}

TEST(EmbreeScene, HitNamesTheInstanceOfASharedMesh) {
  Scene scene;
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 1.0f);
  const glm::mat4 aside = glm::translate(glm::mat4(1.0f), glm::vec3(10, 1, 0));
  scene.instances.push_back({0, glm::scale(aside, glm::vec3(2.0f))});
  const EmbreeScene geometry(scene);
  const auto first = geometry.intersect({{0, 5, 0}, kDown});
  const auto second = geometry.intersect({{11.5f, 5, 0}, kDown});  // a hit only if scaled
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->instance, 0U);
  EXPECT_EQ(second->instance, 1U);
  EXPECT_FLOAT_EQ(second->t, 4.0f);
  EXPECT_FLOAT_EQ(geometry.area_scale(1), 4.0f);
}

TEST(EmbreeScene, MovedInstancesAreHitAtTheirNewPose) {
  Scene scene;
  const int material = add_material(scene, glm::vec3(0.5f));
  add_floor(scene, material, 1.0f);
  add_floor(scene, material, 1.0f);
  EmbreeScene geometry(scene, 1);
  for (const float height : {0.5f, 1.5f, 0.25f}) {
    const std::vector<glm::mat4> poses{
        glm::rotate(glm::translate(glm::mat4(1.0f), glm::vec3(0, height, 0)), 0.3f, {0, 0, 1})};
    geometry.set_poses(poses);
    const auto hit = geometry.intersect({{0, 5, 0}, kDown});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->instance, 1U);
    EXPECT_NEAR(hit->t, 5.0f - height, 1e-5f);
    EXPECT_NEAR(std::abs(hit->normal.y), std::cos(0.3f), 1e-5f);
  }
  EXPECT_THROW(geometry.set_poses({}), std::invalid_argument);
}

TEST(EmbreeScene, HolesLetRaysThrough) {
  Scene scene;
  const int leaf = add_material(scene, glm::vec3(1.0f));
  scene.materials[0].texture = 0;
  scene.materials[0].alpha_cutoff = 0.5f;
  scene.textures.push_back(half_clear());
  test::add_quad(scene, leaf, {glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)});
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 5.0f);
  const EmbreeScene geometry(scene);
  EXPECT_EQ(geometry.intersect({{0.2f, 2, 0.5f}, kDown})->instance, 0U);
  EXPECT_EQ(geometry.intersect({{0.8f, 2, 0.5f}, kDown})->instance, 1U);
  EXPECT_TRUE(geometry.occluded({{0.2f, 2, 0.5f}, kDown, 0.0f, 1.5f}));
  EXPECT_FALSE(geometry.occluded({{0.8f, 2, 0.5f}, kDown, 0.0f, 1.5f}));
}

TEST(EmbreeScene, EachGlassPaneTintsOnce) {
  Scene scene;
  const int blue = add_material(scene, {0.5f, 0.5f, 1.0f});
  const int red = add_material(scene, {1.0f, 0.5f, 0.25f});
  for (Material& material : scene.materials) material.thin_glass = true;
  add_floor(scene, blue, 1.0f, 1.0f);
  add_floor(scene, red, 1.0f, 2.0f);
  const EmbreeScene geometry(scene);
  const glm::vec3 from(0.3f, 3, 0.1f);
  EXPECT_FALSE(geometry.intersect({from, kDown}));
  EXPECT_FALSE(geometry.occluded({from, kDown}));
  EXPECT_EQ(geometry.glass_tint({from, kDown}), glm::vec3(0.5f, 0.25f, 0.25f));
  EXPECT_EQ(geometry.glass_tint({from, kDown, 0.0f, 1.5f}), glm::vec3(1.0f, 0.5f, 0.25f));
  EXPECT_EQ(geometry.glass_tint({{3, 3, 0}, kDown}), glm::vec3(1.0f));
}

// The rays are aimed at edges and corners that the twelve triangles of a closed cube share.
TEST(EmbreeScene, NoRayLeavesAClosedCube) {
  Scene scene;
  test::add_cube(scene, add_material(scene, glm::vec3(0.5f)));
  const EmbreeScene geometry(scene);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> inside(-0.9f, 0.9f);
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 origin(inside(random), inside(random), inside(random));
    glm::vec3 target(inside(random), 1, 1);  // on an edge
    if (i % 3 == 0) target.x = 1;
    if (i % 3 == 1) target = {target.x, target.x, 1};  // on a diagonal
    EXPECT_TRUE(geometry.intersect({origin, glm::normalize(target - origin)}));
  }
}

// Quick rays can leave the cube, but rarely do.
TEST(EmbreeScene, QuickRaysLeaveAClosedCubeLessThanOnceInAHundredThousand) {
  Scene scene;
  test::add_cube(scene, add_material(scene, glm::vec3(0.5f)));
  const EmbreeScene geometry(scene);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> inside(-0.9f, 0.9f);
  int leaks = 0;
  for (int i = 0; i < 400000; ++i) {
    const glm::vec3 origin(inside(random), inside(random), inside(random));
    const glm::vec3 target(inside(random), inside(random), inside(random));
    Ray ray{origin, glm::normalize(target - origin)};
    ray.quick = true;
    if (!geometry.intersect(ray) || !geometry.occluded(ray)) ++leaks;
  }
  EXPECT_LE(leaks, 3);
}

TEST(EmbreeScene, QuickRaysHitTheSameTriangles) {
  Scene scene;
  const int leaf = add_material(scene, glm::vec3(1.0f));
  scene.materials[0].texture = 0;
  scene.materials[0].alpha_cutoff = 0.5f;
  scene.textures.push_back(half_clear());
  test::add_quad(scene, leaf, {glm::vec3(0, 1, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)});
  const int stone = add_material(scene, glm::vec3(0.5f));
  add_floor(scene, stone, 5.0f);
  add_floor(scene, stone, 0.5f, 0.5f);
  const EmbreeScene geometry(scene, 1);
  std::mt19937 random(4);
  std::uniform_real_distribution<float> wide(-1.0f, 2.0f);
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 origin(wide(random), 2.0f, wide(random));
    Ray ray{origin, glm::normalize(glm::vec3(wide(random), 0, wide(random)) - origin)};
    const auto exact = geometry.intersect(ray);
    ray.quick = true;
    const auto quick = geometry.intersect(ray);
    ASSERT_TRUE(exact && quick);
    EXPECT_EQ(quick->instance, exact->instance);
    EXPECT_EQ(quick->triangle, exact->triangle);
    EXPECT_NEAR(quick->t, exact->t, 1e-5f);
    EXPECT_NEAR(quick->u, exact->u, 1e-4f);
    EXPECT_NEAR(quick->v, exact->v, 1e-4f);
  }
}

TEST(EmbreeScene, ErrorNamesTheBadIndex) {
  Scene scene;
  add_floor(scene, add_material(scene, glm::vec3(0.5f)), 1.0f);
  scene.meshes[0].name = "floor";
  scene.meshes[0].triangles[1].z = 9;
  try {
    const EmbreeScene geometry(scene);
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(), "mesh 'floor': triangle (0, 2, 9): expected indices below 4");
  }
}

TEST(EmbreeScene, RaysMissAnEmptyScene) {
  const Scene scene;
  const EmbreeScene geometry(scene);
  EXPECT_FALSE(geometry.intersect({}));
  EXPECT_FALSE(geometry.occluded({}));
}

}  // namespace
}  // namespace eigenlight
