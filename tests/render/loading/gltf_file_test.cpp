// Scenes from glTF files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/render/loading/scene_file_fixture.h"

namespace eigenlight {
namespace {

using test::material;
using test::SceneFile;
using testing::ElementsAre;
using testing::HasSubstr;

/// Two nodes with the same triangle at x in [0, 1]. Its embedded image is a PNG of one color, (10,
/// 100, 200).
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

TEST_F(GltfFile, NodesOfOneMeshKeepTheirTransforms) {
  const Scene scene = load("m.gltf");
  ASSERT_EQ(scene.meshes.size(), 1U);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].to_world, glm::mat4(1.0f));
  EXPECT_EQ(glm::vec3(scene.instances[1].to_world[3]), glm::vec3(10, 0, 0));
}

TEST_F(GltfFile, TexcoordsAndEmbeddedImageAreRead) {
  const Scene scene = load("m.gltf");
  ASSERT_THAT(notes_, testing::Contains(HasSubstr("bare model")));
  ASSERT_THAT(notes_, testing::SizeIs(1));
  EXPECT_THAT(scene.meshes.at(0).texcoords,
              ElementsAre(glm::vec2(0, 0.75f), glm::vec2(1, 0.75f), glm::vec2(0, 0.25f)));
  EXPECT_THAT(scene.textures.at(0).rgba, ElementsAre(10, 100, 200, 255));
  EXPECT_EQ(material(scene, "leaf").base_color, glm::vec3(0.5f, 1, 1));
  // No pixel of this image has an alpha below the cutoff, so there are no holes.
  EXPECT_EQ(material(scene, "leaf").alpha_cutoff, 0.0f);
}

TEST_F(GltfFile, MaskSetsTheAlphaCutoff) {
  // A TGA of one pixel with an alpha of 10 / 255.
  const std::string header("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\x08", 18);
  write("leaf.tga", header + "\xc8\x64\x0a" + "\x0a");
  std::string text = kGltf;
  const std::size_t uri = text.find("data:image"), end = text.find('"', uri);
  write("m.gltf", text.replace(uri, end - uri, "leaf.tga"));
  const Scene scene = load("m.gltf");
  EXPECT_THAT(scene.textures.at(0).rgba, ElementsAre(10, 100, 200, 10));
  EXPECT_EQ(material(scene, "leaf").alpha_cutoff, 0.25f);
}

}  // namespace
}  // namespace eigenlight
