#include "render/builtin/builtin_scenes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "render/scene/clearance.h"

namespace eigenlight {
namespace {

class BuiltinSceneTest : public testing::TestWithParam<BuiltinScene> {};

std::size_t triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& i : scene.instances) {
    count += scene.meshes[static_cast<std::size_t>(i.mesh)].triangles.size();
  }
  return count;
}

TEST_P(BuiltinSceneTest, SceneIsValid) {
  const Scene scene = GetParam().make();
  EXPECT_EQ(scene.name, GetParam().name);
  EXPECT_EQ(scene.missing_textures, 0);
  for (const Material& m : scene.materials) {
    EXPECT_LT(m.texture, static_cast<int>(scene.textures.size()));
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(m.base_color[c], 0.0f);
      EXPECT_LE(m.base_color[c], 1.0f);
    }
  }
  for (const Texture& t : scene.textures) EXPECT_EQ(t.rgba.size(), t.extent.pixels() * 4);
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(static_cast<std::size_t>(mesh.material), scene.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const glm::uvec3& t : mesh.triangles) {
      ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size());
      const glm::vec3& a = mesh.positions[t.x];
      const glm::vec3 face = cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
      ASSERT_GT(length(face), 0.0f) << mesh.name;
      ASSERT_GT(dot(face, mesh.normals[t.x]), 0.0f) << mesh.name;
    }
  }
}

TEST_P(BuiltinSceneTest, CameraPathStaysClearOfSurfaces) {
  const Scene scene = GetParam().make();
  const Clearance clearance(scene);
  ASSERT_GE(scene.camera_path.size(), 2U);
  EXPECT_GE(scene.camera_path.back().seconds - scene.camera_path.front().seconds, 4.0f);
  for (std::size_t i = 0; i + 1 < scene.camera_path.size(); ++i) {
    const CameraKey &from = scene.camera_path[i], &to = scene.camera_path[i + 1];
    EXPECT_GT(to.seconds, from.seconds);
    for (int step = 0; step <= 20; ++step) {
      const glm::vec3 eye = mix(from.eye, to.eye, static_cast<float>(step) / 20.0f);
      EXPECT_GT(clearance.distance(eye, 10.0f), 0.3f) << "key " << i << " step " << step;
    }
  }
}

TEST_P(BuiltinSceneTest, SceneIsReproducible) {
  const Scene a = GetParam().make(), b = GetParam().make();
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions);
  }
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i].rgba, b.textures[i].rgba);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BuiltinSceneTest, testing::ValuesIn(builtin_scenes()),
                         [](const auto& built) { return std::string(built.param.name); });

TEST(BuiltinScenes, SizesMatchTheDocumentation) {
  EXPECT_EQ(triangles(make_builtin_scene("cornell")), 30U);
  const Scene atrium = make_builtin_scene("atrium");
  EXPECT_GE(triangles(atrium), 50'000U);
  const Clearance clearance(atrium);
  const glm::vec3 size = clearance.upper() - clearance.lower();
  EXPECT_NEAR(size.x, 30.0f, 1.0f);
  EXPECT_NEAR(size.y, 11.0f, 0.5f);
  EXPECT_NEAR(size.z, 12.0f, 1.0f);
}

TEST(BuiltinScenes, ErrorListsTheKnownScenes) {
  try {
    (void)make_builtin_scene("sponza");
    FAIL() << "expected an exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("'sponza'"),
                                             testing::HasSubstr("cornell, atrium, gallery")));
  }
}

}  // namespace
}  // namespace eigenlight
