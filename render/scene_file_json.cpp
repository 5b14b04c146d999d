#include "render/scene_file_json.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace eigenlight {
namespace {

using nlohmann::json;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Closed range of numbers, and how a message words it.
struct Range {
  float low, high;
  const char* expected;
};
constexpr Range kAny{-kInfinity, kInfinity, "a number"};
constexpr Range kNonNegative{0.0f, kInfinity, "a number >= 0"};
constexpr Range kPositive{std::numeric_limits<float>::min(), kInfinity, "a number > 0"};

/// A value of the file that knows its own path, for messages.
class Field {
 public:
  Field(const json& value, std::string file, std::string path)
      : value_(&value), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& expected) const {
    throw std::runtime_error(path_.empty() ? fmt::format("{}: {}", file_, expected)
                                           : fmt::format("{}: {}: {}", file_, path_, expected));
  }
  [[nodiscard]] bool has(const char* key) const {
    return value_->is_object() && value_->contains(key);
  }
  [[nodiscard]] Field operator[](const char* key) const {
    if (!value_->is_object()) fail("expected an object");
    const std::string path = path_.empty() ? key : path_ + "." + key;
    const auto found = value_->find(key);
    if (found == value_->end())
      throw std::runtime_error(fmt::format("{}: {}: missing", file_, path));
    return {*found, file_, path};
  }
  [[nodiscard]] std::vector<Field> items() const {
    if (!value_->is_array()) fail("expected a list");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < value_->size(); ++i) {
      fields.emplace_back((*value_)[i], file_, fmt::format("{}[{}]", path_, i));
    }
    return fields;
  }
  [[nodiscard]] std::string text() const {
    if (!value_->is_string()) fail("expected text");
    return value_->get<std::string>();
  }
  [[nodiscard]] float number(const Range& range = kAny) const {
    if (!value_->is_number()) fail(fmt::format("expected {}", range.expected));
    const float number = value_->get<float>();
    if (!std::isfinite(number) || number < range.low || number > range.high) {
      fail(fmt::format("expected {}, got {}", range.expected, value_->dump()));
    }
    return number;
  }
  [[nodiscard]] glm::vec3 vec3(const Range& range = kAny) const {
    const bool any = range.low == kAny.low;
    const auto expected = any ? std::string("expected 3 numbers")
                              : fmt::format("expected 3 numbers, each {}", range.expected);
    if (!value_->is_array() || value_->size() != 3) fail(expected);
    glm::vec3 v(0.0f);
    for (int c = 0; c < 3; ++c) {
      const json& item = (*value_)[static_cast<std::size_t>(c)];
      if (!item.is_number()) fail(expected);
      v[c] = item.get<float>();
      if (!std::isfinite(v[c]) || v[c] < range.low || v[c] > range.high) fail(expected);
    }
    return v;
  }
  /// A vector that is not zero, made unit.
  [[nodiscard]] glm::vec3 direction() const {
    const glm::vec3 v = vec3();
    if (!(dot(v, v) > 0.0f)) fail("expected a direction, got 0, 0, 0");
    return normalize(v);
  }

 private:
  const json* value_;
  std::string file_, path_;
};

void read_camera(const Field& camera, SceneDescription& scene) {
  scene.fov_y = camera["fov_y_degrees"].number({1.0f, 179.0f, "degrees in [1, 179]"});
  if (camera.has("up")) scene.up = camera["up"].direction();
  const Field keyframes = camera["keyframes"];
  for (const Field& item : keyframes.items()) {
    const CameraKey key{item["t"].number(), item["eye"].vec3(), item["look_at"].vec3()};
    if (key.eye == key.look_at) item["look_at"].fail("expected a point other than eye");
    if (!scene.camera_path.empty() && !(key.seconds > scene.camera_path.back().seconds)) {
      item["t"].fail("expected seconds after those of the key before");
    }
    scene.camera_path.push_back(key);
  }
  if (scene.camera_path.empty()) keyframes.fail("expected at least one key");
}

void read_sun(const Field& light, Lights& lights) {
  SunLight sun{light["direction_to_light"].direction(), light["irradiance"].vec3(kNonNegative)};
  if (light.has("angular_diameter_degrees")) {
    sun.angular_diameter =
        light["angular_diameter_degrees"].number({0.0f, 90.0f, "degrees in [0, 90]"});
  }
  lights.suns.push_back(sun);
}

void read_area_rect(const Field& light, Lights& lights) {
  const AreaRect rect{light["center"].vec3(), light["half_u"].vec3(), light["half_v"].vec3(),
                      light["radiance"].vec3(kNonNegative)};
  const glm::vec3 normal = cross(rect.half_u, rect.half_v);
  if (!(dot(normal, normal) > 0.0f)) {
    light["half_v"].fail("expected a vector not parallel to half_u");
  }
  lights.rects.push_back(rect);
}

void read_light(const Field& light, SceneDescription& scene) {
  const std::string type = light["type"].text();
  if (type == "sun") {
    read_sun(light, scene.lights);
  } else if (type == "sky") {
    scene.lights.sky += light["radiance"].vec3(kNonNegative);
  } else if (type == "area_rect") {
    read_area_rect(light, scene.lights);
  } else if (type == "sphere") {
    scene.lights.spheres.push_back({light["center"].vec3(), light["radius"].number(kPositive),
                                    light["radiance"].vec3(kNonNegative)});
  } else if (type == "emissive_material") {
    scene.emissive_materials[light["material"].text()] = light["radiance"].vec3(kNonNegative);
  } else {
    light["type"].fail(fmt::format(
        "unknown light \"{}\", expected sun, sky, area_rect, sphere or emissive_material", type));
  }
}

json parse_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot open scene file", path.string()));
  try {
    return json::parse(in);
  } catch (const json::parse_error& error) {
    throw std::runtime_error(
        fmt::format("{}: broken JSON at byte {}", short_name(path), error.byte));
  }
}

}  // namespace

std::string short_name(const std::filesystem::path& path) {
  const auto folder = path.parent_path().filename();
  return (folder / path.filename()).string();
}

SceneDescription read_scene_json(const std::filesystem::path& path) {
  const json document = parse_file(path);
  const Field root(document, short_name(path), "");
  SceneDescription scene;
  const std::string fallback = path.parent_path().filename().string();
  scene.name = root.has("name") ? root["name"].text() : fallback;
  scene.title = root.has("title") ? root["title"].text() : scene.name;
  scene.model = path.parent_path() / root["file"].text();
  if (!std::filesystem::is_regular_file(scene.model)) {
    root["file"].fail(fmt::format("no such file: {}", scene.model.string()));
  }
  read_camera(root["camera"], scene);
  for (const Field& light : root["lights"].items()) read_light(light, scene);
  if (root.has("exposure")) scene.exposure = root["exposure"].number(kPositive);
  if (root.has("thin_glass_materials")) {
    for (const Field& name : root["thin_glass_materials"].items()) {
      scene.thin_glass_materials.push_back(name.text());
    }
  }
  if (root.has("environment")) {
    const Field environment = root["environment"];
    scene.environment = path.parent_path() / environment["file"].text();
    if (environment.has("scale")) {
      scene.environment_scale = environment["scale"].number(kNonNegative);
    }
  }
  return scene;
}

}  // namespace eigenlight
