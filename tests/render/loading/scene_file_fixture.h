// Scene files in a temporary folder.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/loading/scene_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight::test {

inline constexpr const char* kObj =
    "mtllib m.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl painted\nf 1/1 2/2 3/3 4/4\n"
    "usemtl lamp\nf 1 2 5\n";
inline constexpr const char* kMtl =
    "newmtl painted\nKd 0.8 0.4 0.2\nmap_Kd paint.ppm\n"
    "newmtl lamp\nKd 0.1 0.1 0.1\nKe 17 12 4\n";
inline constexpr const char* kCamera =
    R"("camera": {"fov_y_degrees": 45, "keyframes": [{"t": 0, "eye": [0, 0, 5], "look_at": [0, 0, 0]}]})";

/// A folder "box" with the model m.obj. It is deleted after the test.
class SceneFile : public testing::Test {
 protected:
  SceneFile() {
    std::filesystem::create_directory(folder_);
    write("m.obj", kObj);
    write("m.mtl", kMtl);
    // 2 x 2 pixels: red and green above blue and white.
    write("paint.ppm", std::string("P6\n2 2\n255\n") + "\xff" + std::string(3, '\0') + "\xff" +
                           std::string(3, '\0') + "\xff\xff\xff\xff");
  }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  /// Writes a scene.json for m.obj with the given lights and further fields.
  void write_scene(const std::string& lights, const std::string& more = "") const {
    write("scene.json", std::string(R"({"file": "m.obj", )") + kCamera + R"(, "lights": [)" +
                            lights + "]" + more + "}");
  }
  Scene load(const std::string& name, const SceneFileOptions& options = {}) {
    notes_.clear();
    return load_scene(folder_ / name, options, notes_);
  }
  /// The message of the exception that loading throws; it must be one line.
  std::string error(const std::string& name, const SceneFileOptions& options = {}) {
    try {
      (void)load(name, options);
    } catch (const std::runtime_error& failure) {
      EXPECT_THAT(failure.what(), testing::Not(testing::HasSubstr("\n")));
      return failure.what();
    }
    return "no exception";
  }
  /// The message for a scene.json with this content.
  std::string json_error(const std::string& content) {
    write("scene.json", content);
    return error("scene.json");
  }

  TempDir temp_;
  std::filesystem::path folder_ = temp_ / "box";
  std::vector<std::string> notes_;
};

/// The material called `name`.
inline const Material& material(const Scene& scene, const std::string& name) {
  for (const Material& m : scene.materials) {
    if (m.name == name) return m;
  }
  throw std::runtime_error("no material " + name);
}

/// Number of triangles of all instances.
inline std::size_t triangles(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& i : scene.instances) {
    count += scene.meshes[static_cast<std::size_t>(i.mesh)].triangles.size();
  }
  return count;
}

}  // namespace eigenlight::test
