// Scenes from scene.json and OBJ files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "render/loading/image_file.h"
#include "sequences/exr/exr_write.h"
#include "tests/render/loading/scene_file_fixture.h"

namespace eigenlight {
namespace {

using test::kObj;
using test::material;
using test::SceneFile;
using test::triangles;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(SceneFile, BareObjGetsACameraAndLights) {
  const Scene scene = load("m.obj");
  EXPECT_EQ(triangles(scene), 3U);
  EXPECT_EQ(material(scene, "lamp").emission, glm::vec3(17, 12, 4));
  EXPECT_EQ(material(scene, "painted").base_color, glm::vec3(0.8f, 0.4f, 0.2f));
  EXPECT_GE(material(scene, "painted").texture, 0);
  EXPECT_EQ(material(scene, "painted").alpha_cutoff, 0.0f);
  EXPECT_EQ(scene.lights.suns.size(), 1U);
  EXPECT_GE(scene.camera_path.size(), 2U);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("bare model")));
}

// OBJ has v = 0 at the bottom and Texture at the top, so the top left corner shows the first texel.
TEST_F(SceneFile, ObjTextureIsUpright) {
  const Scene scene = load("m.obj");
  const Texture& texture = scene.textures.at(0);
  EXPECT_EQ(texture.extent, (Extent{2, 2}));
  EXPECT_THAT(std::vector<std::uint8_t>(texture.rgba.begin(), texture.rgba.begin() + 8),
              ElementsAre(255, 0, 0, 255, 0, 255, 0, 255));
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.texcoords.empty()) continue;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_FLOAT_EQ(mesh.texcoords[i].x, mesh.positions[i].x);
      EXPECT_FLOAT_EQ(mesh.texcoords[i].y, 1.0f - mesh.positions[i].y);
    }
  }
}

TEST_F(SceneFile, OrbitShowsTheWholeModel) {
  const Scene scene = load("m.obj");
  for (const CameraKey& key : scene.camera_path) {
    const float radius = 0.5f * glm::length(glm::vec3(1, 1, 2));
    EXPECT_GT(distance(key.eye, key.look_at) * std::sin(glm::radians(scene.fov_y * 0.5f)), radius);
    EXPECT_NEAR(distance(key.look_at, glm::vec3(0.5f, 0.5f, 1.0f)), 0.0f, 1e-5f);
  }
}

TEST_F(SceneFile, MissingTextureIsReplacedByGray) {
  std::filesystem::remove(folder_ / "paint.ppm");
  const Scene scene = load("m.obj");
  EXPECT_EQ(scene.missing_textures, 1);
  EXPECT_EQ(material(scene, "painted").texture, -1);
  EXPECT_EQ(material(scene, "painted").base_color, 0.5f * glm::vec3(0.8f, 0.4f, 0.2f));
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("paint.ppm")));
}

TEST_F(SceneFile, InvalidTrianglesAndPointMeshesAreDropped) {
  write("m.obj", std::string(kObj) + "o point\nv 3 3 3\nf 6 6 6\no broken\nv nan 0 0\nf 1 2 7\n");
  const Scene scene = load("m.obj");
  EXPECT_EQ(triangles(scene), 3U);
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("NaN")));
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("all its triangles are points")));
}

TEST_F(SceneFile, EveryKindOfLightIsRead) {
  write_scene(R"({"type": "sun", "direction_to_light": [0, 2, 0], "irradiance": [5, 4, 3],
                  "angular_diameter_degrees": 2},
                 {"type": "sky", "radiance": [1, 2, 3]},
                 {"type": "area_rect", "center": [1, 2, 3], "half_u": [1, 0, 0],
                  "half_v": [0, 0, 2], "radiance": [7, 8, 9]},
                 {"type": "sphere", "center": [4, 5, 6], "radius": 0.5, "radiance": [1, 1, 1]},
                 {"type": "emissive_material", "material": "painted", "radiance": [3, 2, 1]})",
              R"(, "exposure": 2.5, "thin_glass_materials": ["lamp"])");
  const Scene scene = load("scene.json");
  ASSERT_EQ(scene.lights.suns.size(), 1U);
  EXPECT_EQ(scene.lights.suns[0].to_light, glm::vec3(0, 1, 0));
  EXPECT_EQ(scene.lights.suns[0].irradiance, glm::vec3(5, 4, 3));
  EXPECT_EQ(scene.lights.suns[0].angular_diameter, 2.0f);
  EXPECT_EQ(scene.lights.sky, glm::vec3(1, 2, 3));
  ASSERT_EQ(scene.lights.rects.size(), 1U);
  EXPECT_EQ(scene.lights.rects[0].half_v, glm::vec3(0, 0, 2));
  ASSERT_EQ(scene.lights.spheres.size(), 1U);
  EXPECT_EQ(scene.lights.spheres[0].radius, 0.5f);
  EXPECT_EQ(material(scene, "painted").emission, glm::vec3(3, 2, 1));
  EXPECT_TRUE(material(scene, "lamp").thin_glass);
  EXPECT_EQ(scene.exposure, 2.5f);
  EXPECT_EQ(scene.name, "box");
  // The lamp emits in the model but not in scene.json, which takes precedence.
  EXPECT_EQ(material(scene, "lamp").emission, glm::vec3(0));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("\"lamp\" emits")));
}

// Colors of 3 x 2 pixels; channels of another layer and a depth stand before them in the file.
void write_exr_map(const std::filesystem::path& path, ExrType type, const std::string& layer) {
  Planes<3> color = make_planes<3>({3, 2});
  Plane<float> alpha({3, 2}), other({3, 2});
  for (int c = 0; c < 3; ++c) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 3; ++x) {
        color[c](x, y) = 0.25f * static_cast<float>(1 + c) + static_cast<float>(10 * y + x);
      }
    }
  }
  alpha.fill(0.5f);
  other.fill(77.0f);
  const ExrChannel channels[] = {
      {"A.depth", ExrType::kFloat, &other}, {layer + "R", type, &color[0]},
      {layer + "G", type, &color[1]},       {layer + "B", type, &color[2]},
      {layer + "A", type, &alpha},          {"zz.R", ExrType::kHalf, &other}};
  write_exr(path, channels, {});
}

TEST_F(SceneFile, EnvironmentsInExrFilesAreReadAsTheyAre) {
  for (const ExrType type : {ExrType::kHalf, ExrType::kFloat}) {
    for (const char* layer : {"", "View.Combined."}) {
      write_exr_map(folder_ / "sky.exr", type, layer);
      const Environment map = read_environment(folder_ / "sky.exr", 2.0f);
      ASSERT_EQ(map.extent, (Extent{3, 2}));
      EXPECT_EQ(map.radiance[0], glm::vec3(0.5f, 1.0f, 1.5f));
      EXPECT_EQ(map.radiance[5], glm::vec3(24.5f, 25.0f, 25.5f));
    }
  }
}

TEST_F(SceneFile, BaseColorsInExrFilesAreLinear) {
  write_exr_map(folder_ / "paint.exr", ExrType::kFloat, "");
  const Texture texture = read_texture(folder_ / "paint.exr");
  ASSERT_EQ(texture.extent, (Extent{3, 2}));
  // sRGB of 0.25, 0.5 and 0.75.
  EXPECT_THAT(std::vector<int>(texture.rgba.begin(), texture.rgba.begin() + 4),
              ElementsAre(137, 188, 225, 128));
  EXPECT_THAT(std::vector<int>(texture.rgba.end() - 4, texture.rgba.end()),
              ElementsAre(255, 255, 255, 128));
}

TEST_F(SceneFile, EnvironmentReplacesSunAndSkyOnRequest) {
  write_scene(R"({"type": "sky", "radiance": [1, 1, 1]})",
              R"(, "environment": {"file": "paint.ppm", "scale": 4})");
  EXPECT_FALSE(load("scene.json").environment.has_value());
  const Scene scene = load("scene.json", {.use_environment = true});
  ASSERT_TRUE(scene.environment.has_value());
  EXPECT_EQ(scene.environment->extent, (Extent{2, 2}));
  EXPECT_EQ(scene.environment->radiance[0], glm::vec3(4, 0, 0));
  EXPECT_EQ(scene.lights.sky, glm::vec3(0));
  write_scene("");
  EXPECT_EQ(error("scene.json", {.use_environment = true}), "box/scene.json: environment: missing");
}

TEST_F(SceneFile, DirectionsAreNormalized) {
  for (const char* direction : {"[0, 1e-30, 0]", "[0, 1e9, 0]", "[0, 1, 0]"}) {
    write_scene(std::string(R"({"type": "sun", "irradiance": [1, 1, 1], "direction_to_light": )") +
                direction + "}");
    const Scene scene = load("scene.json");
    EXPECT_EQ(scene.lights.suns.at(0).to_light, glm::vec3(0, 1, 0)) << direction;
  }
}

}  // namespace
}  // namespace eigenlight
