#include "render/loading/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "render/loading/image_file.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kObj =
    "mtllib m.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl painted\nf 1/1 2/2 3/3 4/4\n"
    "usemtl lamp\nf 1 2 5\n";
constexpr const char* kMtl =
    "newmtl painted\nKd 0.8 0.4 0.2\nmap_Kd paint.ppm\n"
    "newmtl lamp\nKd 0.1 0.1 0.1\nKe 17 12 4\n";
constexpr const char* kCamera =
    R"("camera": {"fov_y_degrees": 45, "keyframes": [{"t": 0, "eye": [0, 0, 5], "look_at": [0, 0, 0]}]})";

/// Files in a folder of their own, gone afterwards.
class SceneFile : public testing::Test {
 protected:
  SceneFile() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("eigenlight_" + std::to_string(getpid()) + "_" + test->name()) / "box";
    std::filesystem::create_directories(folder_);
    write("m.obj", kObj);
    write("m.mtl", kMtl);
    // Two by two: red, green over blue, white.
    write("paint.ppm", std::string("P6\n2 2\n255\n") + "\xff" + std::string(3, '\0') + "\xff" +
                           std::string(3, '\0') + "\xff\xff\xff\xff");
  }
  ~SceneFile() override { std::filesystem::remove_all(folder_.parent_path()); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  /// A scene.json around m.obj, with these lights and further fields.
  void write_scene(const std::string& lights, const std::string& more = "") const {
    write("scene.json", std::string(R"({"file": "m.obj", )") + kCamera + R"(, "lights": [)" +
                            lights + "]" + more + "}");
  }
  Scene load(const std::string& name, const SceneFileOptions& options = {}) {
    notes_.clear();
    return load_scene(folder_ / name, options, notes_);
  }
  std::string error(const std::string& name, const SceneFileOptions& options = {}) {
    try {
      (void)load(name, options);
    } catch (const std::runtime_error& failure) {
      EXPECT_THAT(failure.what(), testing::Not(HasSubstr("\n")));
      return failure.what();
    }
    return "no exception";
  }
  /// Message for a scene.json of this content.
  std::string json_error(const std::string& content) {
    write("scene.json", content);
    return error("scene.json");
  }

  std::filesystem::path folder_;
  std::vector<std::string> notes_;
};

const Material& material(const Scene& scene, const std::string& name) {
  for (const Material& m : scene.materials) {
    if (m.name == name) return m;
  }
  throw std::runtime_error("no material " + name);
}

std::size_t triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& i : scene.instances) {
    count += scene.meshes[static_cast<std::size_t>(i.mesh)].triangles.size();
  }
  return count;
}

TEST_F(SceneFile, BareObjHasItsMaterialsAndGetsCameraAndLight) {
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

// OBJ has v = 0 at the bottom, we at the top: the corner at the top left shows the first texel.
TEST_F(SceneFile, TextureOfAnObjIsUpright) {
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

TEST_F(SceneFile, OrbitSeesTheWholeModel) {
  const Scene scene = load("m.obj");
  for (const CameraKey& key : scene.camera_path) {
    const float radius = 0.5f * glm::length(glm::vec3(1, 1, 2));
    EXPECT_GT(distance(key.eye, key.look_at) * std::sin(glm::radians(scene.fov_y * 0.5f)), radius);
    EXPECT_NEAR(distance(key.look_at, glm::vec3(0.5f, 0.5f, 1.0f)), 0.0f, 1e-5f);
  }
}

TEST_F(SceneFile, MissingTextureIsGreyCountedAndNamed) {
  std::filesystem::remove(folder_ / "paint.ppm");
  const Scene scene = load("m.obj");
  EXPECT_EQ(scene.missing_textures, 1);
  EXPECT_EQ(material(scene, "painted").texture, -1);
  EXPECT_EQ(material(scene, "painted").base_color, 0.5f * glm::vec3(0.8f, 0.4f, 0.2f));
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("paint.ppm")));
}

TEST_F(SceneFile, BrokenTrianglesAndPointMeshesAreDroppedAndNoted) {
  write("m.obj", std::string(kObj) + "o point\nv 3 3 3\nf 6 6 6\no broken\nv nan 0 0\nf 1 2 7\n");
  const Scene scene = load("m.obj");
  EXPECT_EQ(triangles(scene), 3U);
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("NaN")));
  EXPECT_THAT(notes_, testing::Contains(HasSubstr("more than a point")));
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
  // The lamp emits in the model, but not in scene.json, which decides.
  EXPECT_EQ(material(scene, "lamp").emission, glm::vec3(0));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("\"lamp\" emits")));
}

TEST_F(SceneFile, EnvironmentStandsInForSunAndSkyWhenAsked) {
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

TEST_F(SceneFile, BadJsonNamesFileAndField) {
  const std::string camera = std::string(R"({"file": "m.obj", "lights": [], "camera": )");
  EXPECT_THAT(json_error("{"), HasSubstr("box/scene.json: broken JSON at byte"));
  EXPECT_EQ(json_error("[]"), "box/scene.json: expected an object");
  EXPECT_EQ(json_error("{}"), "box/scene.json: file: missing");
  EXPECT_EQ(json_error(R"({"file": 3})"), "box/scene.json: file: expected text");
  EXPECT_THAT(json_error(R"({"file": "no.obj"})"), HasSubstr("file: no such file"));
  EXPECT_EQ(json_error(camera + R"({"fov_y_degrees": 200}})"),
            "box/scene.json: camera.fov_y_degrees: expected degrees in [1, 179], got 200");
  EXPECT_EQ(json_error(camera + R"({"fov_y_degrees": 45, "keyframes": []}})"),
            "box/scene.json: camera.keyframes: expected at least one key");
  const std::string key = R"({"t": 0, "eye": [0, 0, 5], "look_at": [0, 0, 0]})";
  EXPECT_EQ(
      json_error(camera + R"({"fov_y_degrees": 45, "keyframes": [)" + key +
                 R"(, {"t": 1, "eye": [0, 5], "look_at": [0, 0, 0]}]}})"),
      "box/scene.json: camera.keyframes[1].eye: expected 3 numbers, each a number in [-1e9, 1e9]");
  EXPECT_THAT(
      json_error(camera + R"({"fov_y_degrees": 45, "keyframes": [)" + key + "," + key + "]}}"),
      HasSubstr("camera.keyframes[1].t: expected seconds after"));
}

// What float could hold, but not square or turn into frames.
TEST_F(SceneFile, NumbersThatNobodyCanRenderWithAreRefused) {
  const auto path_error = [this](const std::string& last_key) {
    write("scene.json", R"({"file": "m.obj", "lights": [], "camera": {"fov_y_degrees": 45, )"
                        R"("keyframes": [{"t": 0, "eye": [0, 0, 5], "look_at": [0, 0, 0]}, )" +
                            last_key + "]}}");
    return error("scene.json");
  };
  EXPECT_THAT(path_error(R"({"t": 1e9, "eye": [0, 0, 5], "look_at": [0, 0, 0]})"),
              HasSubstr("keyframes[1].t: expected seconds in [-1e6, 1e6], got 1000000000.0"));
  EXPECT_THAT(path_error(R"({"t": 1, "eye": [0, 0, 1e30], "look_at": [0, 0, 0]})"),
              HasSubstr("keyframes[1].eye: expected 3 numbers, each a number in [-1e9, 1e9]"));
  EXPECT_THAT(path_error(R"({"t": 1, "eye": [0, 0, 1e999], "look_at": [0, 0, 0]})"),
              HasSubstr("broken JSON"));
  EXPECT_THAT(path_error(R"({"t": 1, "eye": [0, 0, 1e-30], "look_at": [0, 0, 0]})"),
              HasSubstr("keyframes[1].look_at: expected a point other than eye"));
  write_scene(R"({"type": "sky", "radiance": [1e30, 1, 1]})");
  EXPECT_THAT(error("scene.json"), HasSubstr("each a number in [0, 1e15]"));
  write_scene(R"({"type": "area_rect", "center": [0, 0, 0], "half_u": [1e-15, 0, 0],
                  "half_v": [0, 1e-15, 0], "radiance": [1, 1, 1]})");
  EXPECT_THAT(error("scene.json"), HasSubstr("half_v: expected a vector not parallel"));
}

TEST_F(SceneFile, DirectionsOfAnyLengthAreMadeUnit) {
  for (const char* direction : {"[0, 1e-30, 0]", "[0, 1e9, 0]", "[0, 1, 0]"}) {
    write_scene(std::string(R"({"type": "sun", "irradiance": [1, 1, 1], "direction_to_light": )") +
                direction + "}");
    const Scene scene = load("scene.json");
    EXPECT_EQ(scene.lights.suns.at(0).to_light, glm::vec3(0, 1, 0)) << direction;
  }
}

TEST_F(SceneFile, MessagesStayOneLine) {
  write_scene(R"({"type": "las\ner"})");
  EXPECT_THAT(error("scene.json"), HasSubstr(R"(unknown light "las\ner", expected)"));
}

TEST_F(SceneFile, BadLightsAreNamed) {
  const auto light_error = [this](const std::string& light, const std::string& more = "") {
    write_scene(light, more);
    return error("scene.json");
  };
  EXPECT_THAT(light_error(R"({"type": "laser"})"),
              HasSubstr("lights[0].type: unknown light \"laser\", expected sun, sky"));
  EXPECT_THAT(light_error(R"({"type": "sky", "radiance": [1, -1, 1]})"),
              HasSubstr("lights[0].radiance: expected 3 numbers, each a number in [0, 1e15]"));
  EXPECT_THAT(light_error(R"({"type": "sphere", "center": [0, 0, 0], "radius": 0})"),
              HasSubstr("lights[0].radius: expected a number in [1e-9, 1e9], got 0"));
  EXPECT_THAT(light_error(R"({"type": "sun", "direction_to_light": [0, 0, 0]})"),
              HasSubstr("direction_to_light: expected a direction"));
  EXPECT_EQ(light_error(R"({"type": "emissive_material", "material": "x", "radiance": [1, 1, 1]})"),
            "box/scene.json: lights: no material \"x\" in the model");
  EXPECT_EQ(light_error("", R"(, "thin_glass_materials": ["y"])"),
            "box/scene.json: thin_glass_materials: no material \"y\" in the model");
}

TEST_F(SceneFile, ModelsThatCannotBeUsedAreNamed) {
  EXPECT_THAT(error("none.obj"), HasSubstr("none.obj: no such model file"));
  EXPECT_THAT(error("none.json"), HasSubstr("none.json: cannot open scene file"));
  EXPECT_THAT(error("m.mtl"), HasSubstr("m.mtl: unknown kind of scene"));
  write("dots.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n");
  EXPECT_THAT(error("dots.obj"), HasSubstr("box/dots.obj: no triangles"));
  write("broken.gltf", "{");
  EXPECT_THAT(error("broken.gltf"), HasSubstr("box/broken.gltf: cannot read model"));
}

/// One triangle at x in [0, 1] under two nodes; its image is a PNG of the color (10, 100, 200)
/// inside the file.
constexpr const char* kGltf = R"({"asset": {"version": "2.0"}, "scene": 0,
  "scenes": [{"nodes": [0, 1]}],
  "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [10, 0, 0]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
  "materials": [{"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25,
    "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {"index": 0}}}],
  "textures": [{"source": 0}], "images": [{"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGPgSjkBAAGyATcqK3haAAAAAElFTkSuQmCC"}],
  "buffers": [{"uri": "m.bin", "byteLength": 60}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                 "min": [0, 0, 0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]})";

class GltfFile : public SceneFile {
 protected:
  GltfFile() {
    const float data[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0.75f, 1, 0.75f, 0, 0.25f};
    write("m.bin", std::string(reinterpret_cast<const char*>(data), sizeof(data)));
    write("m.gltf", kGltf);
  }
};

TEST_F(GltfFile, NodesShareAMeshAndKeepTheirPlaces) {
  const Scene scene = load("m.gltf");
  ASSERT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].to_world, glm::mat4(1.0f));
  EXPECT_EQ(glm::vec3(scene.instances[1].to_world[3]), glm::vec3(10, 0, 0));
}

TEST_F(GltfFile, TexcoordsAndEmbeddedImageAreThoseOfTheFile) {
  const Scene scene = load("m.gltf");
  ASSERT_THAT(notes_, testing::Contains(HasSubstr("bare model")));
  ASSERT_THAT(notes_, testing::SizeIs(1));
  EXPECT_THAT(scene.meshes.at(0).texcoords,
              ElementsAre(glm::vec2(0, 0.75f), glm::vec2(1, 0.75f), glm::vec2(0, 0.25f)));
  EXPECT_THAT(scene.textures.at(0).rgba, ElementsAre(10, 100, 200, 255));
  EXPECT_EQ(material(scene, "leaf").base_color, glm::vec3(0.5f, 1, 1));
  // Nothing in this image is under the cutoff, so that there are no holes to look for.
  EXPECT_EQ(material(scene, "leaf").alpha_cutoff, 0.0f);
}

TEST_F(GltfFile, MaskHasHolesWhereAlphaIsLow) {
  // A TGA of one pixel of alpha 10 of 255.
  const std::string header("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\x08", 18);
  write("leaf.tga", header + "\xc8\x64\x0a" + "\x0a");
  std::string text = kGltf;
  const std::size_t uri = text.find("data:image"), end = text.find('"', uri);
  write("m.gltf", text.replace(uri, end - uri, "leaf.tga"));
  const Scene scene = load("m.gltf");
  EXPECT_THAT(scene.textures.at(0).rgba, ElementsAre(10, 100, 200, 10));
  EXPECT_EQ(material(scene, "leaf").alpha_cutoff, 0.25f);
}

TEST_F(SceneFile, ImagesThatCannotBeUsedAreNamed) {
  EXPECT_THROW((void)read_texture(folder_ / "none.png"), std::runtime_error);
  EXPECT_THROW((void)read_texture(std::span<const std::uint8_t>(), "empty.png"),
               std::runtime_error);
  EXPECT_THROW((void)read_environment(folder_ / "m.obj", 1.0f), std::runtime_error);
}

}  // namespace
}  // namespace eigenlight
