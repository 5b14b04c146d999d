// Error messages of scene files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "render/loading/image_file.h"
#include "sequences/exr/exr_write.h"
#include "tests/render/loading/scene_file_fixture.h"

namespace eigenlight {
namespace {

using test::SceneFile;
using testing::HasSubstr;

TEST_F(SceneFile, ErrorNamesFileAndFieldOfBadJson) {
  const std::string camera = std::string(R"({"file": "m.obj", "lights": [], "camera": )");
  EXPECT_THAT(json_error("{"), HasSubstr("box/scene.json: broken JSON at byte"));
  EXPECT_EQ(json_error("[]"), "box/scene.json: expected an object");
  EXPECT_EQ(json_error("{}"), "box/scene.json: file: missing");
  EXPECT_EQ(json_error(R"({"file": 3})"), "box/scene.json: file: expected text");
  EXPECT_THAT(json_error(R"({"file": "no.obj"})"), HasSubstr("file: no such file"));
  EXPECT_EQ(json_error(camera + R"({"fov_y_degrees": 200}})"),
            "box/scene.json: camera.fov_y_degrees: expected degrees in [1, 179], got 200");
  EXPECT_EQ(json_error(camera + R"({"fov_y_degrees": 45, "keyframes": []}})"),
            "box/scene.json: camera.keyframes: expected at least one keyframe");
  const std::string key = R"({"t": 0, "eye": [0, 0, 5], "look_at": [0, 0, 0]})";
  EXPECT_EQ(
      json_error(camera + R"({"fov_y_degrees": 45, "keyframes": [)" + key +
                 R"(, {"t": 1, "eye": [0, 5], "look_at": [0, 0, 0]}]}})"),
      "box/scene.json: camera.keyframes[1].eye: expected 3 numbers, each a number in [-1e9, 1e9]");
  EXPECT_THAT(
      json_error(camera + R"({"fov_y_degrees": 45, "keyframes": [)" + key + "," + key + "]}}"),
      HasSubstr("camera.keyframes[1].t: expected more seconds than in the previous"));
}

// These numbers fit into a float, but their squares or frame numbers overflow.
TEST_F(SceneFile, NumbersOutOfRangeAreRejected) {
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

TEST_F(SceneFile, ErrorMessageIsOneLine) {
  write_scene(R"({"type": "las\ner"})");
  EXPECT_THAT(error("scene.json"), HasSubstr(R"(unknown light "las\ner", expected)"));
}

TEST_F(SceneFile, ErrorNamesTheBadLight) {
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

TEST_F(SceneFile, ErrorNamesTheUnreadableModel) {
  EXPECT_THAT(error("none.obj"), HasSubstr("none.obj: no such model file"));
  EXPECT_THAT(error("none.json"), HasSubstr("none.json: cannot open scene file"));
  EXPECT_THAT(error("m.mtl"), HasSubstr("m.mtl: unknown kind of scene"));
  write("dots.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n");
  EXPECT_THAT(error("dots.obj"), HasSubstr("box/dots.obj: no triangles"));
  write("broken.gltf", "{");
  EXPECT_THAT(error("broken.gltf"), HasSubstr("box/broken.gltf: cannot read model"));
}

TEST_F(SceneFile, ErrorNamesTheUnreadableImage) {
  const auto throws = [](const std::string& name) {
    return testing::ThrowsMessage<std::runtime_error>(HasSubstr(name + ": cannot read image"));
  };
  EXPECT_THAT([this] { (void)read_texture(folder_ / "none.png"); }, throws("none.png"));
  EXPECT_THAT([] { (void)read_texture(std::span<const std::uint8_t>(), "empty.png"); },
              throws("empty.png"));
  EXPECT_THAT([this] { (void)read_environment(folder_ / "m.obj", 1.0f); }, throws("m.obj"));
  const Plane<float> gray({2, 2});
  const ExrChannel channels[] = {{"Y", ExrType::kHalf, &gray}};
  write_exr(folder_ / "gray.exr", channels, {});
  EXPECT_THAT([this] { (void)read_environment(folder_ / "gray.exr", 1.0f); }, throws("gray.exr"));
  write("cut.exr", "v/1\x01");
  EXPECT_THAT([this] { (void)read_environment(folder_ / "cut.exr", 1.0f); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("cut.exr")));
}

}  // namespace
}  // namespace eigenlight
