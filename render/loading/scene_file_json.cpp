#include "render/loading/scene_file_json.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "frame/float_traps.h"

namespace eigenlight {
namespace {

using nlohmann::json;

/// Closed range of numbers, and its description in error messages.
struct Range {
  float low, high;
  const char* expected;

  /// Whether `number` is in the range and does not overflow as a float.
  [[nodiscard]] bool holds(double number) const {
    return std::abs(number) <= std::numeric_limits<float>::max() &&
           number >= static_cast<double>(low) && number <= static_cast<double>(high);
  }
};
// Positions and lengths: their squares and the squares of their products fit into a float.
constexpr float kFar = 1e9f;
constexpr Range kCoordinate{-kFar, kFar, "a number in [-1e9, 1e9]"};
constexpr Range kLength{1e-9f, kFar, "a number in [1e-9, 1e9]"};
// Light: a thousand such values add up to less than kLargestLight, which the denoiser can square.
constexpr Range kLight{0.0f, 1e15f, "a number in [0, 1e15]"};
constexpr Range kExposure{1e-9f, kFar, "a number in [1e-9, 1e9]"};
// Eleven days, so that the last frame number fits into the range of frame numbers.
constexpr Range kSeconds{-1e6f, 1e6f, "seconds in [-1e6, 1e6]"};

/// A JSON value with its file and path for error messages.
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
  [[nodiscard]] float number(const Range& range) const {
    if (!value_->is_number()) fail(fmt::format("expected {}", range.expected));
    if (!range.holds(value_->get<double>())) {
      fail(fmt::format("expected {}, got {}", range.expected, value_->dump()));
    }
    return value_->get<float>();
  }
  [[nodiscard]] glm::vec3 vec3(const Range& range = kCoordinate) const {
    const auto expected = fmt::format("expected 3 numbers, each {}", range.expected);
    if (!value_->is_array() || value_->size() != 3) fail(expected);
    glm::vec3 v(0.0f);
    for (int c = 0; c < 3; ++c) {
      const json& item = (*value_)[static_cast<std::size_t>(c)];
      if (!item.is_number()) fail(expected);
      if (!range.holds(item.get<double>())) fail(expected);
      v[c] = item.get<float>();
    }
    return v;
  }
  /// A unit vector from a vector of any length but 0.
  [[nodiscard]] glm::vec3 direction() const {
    // The square of a small float underflows in float, but not in double.
    const glm::dvec3 v(vec3());
    if (v == glm::dvec3(0.0)) fail("expected a direction, got 0, 0, 0");
    return glm::vec3(normalize(v));
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
    const CameraKey key{item["t"].number(kSeconds), item["eye"].vec3(), item["look_at"].vec3()};
    // The squares of shorter distances lose digits or underflow to 0.
    if (distance(key.eye, key.look_at) < 1e-15f) {
      item["look_at"].fail("expected a point other than eye");
    }
    if (!scene.camera_path.empty() && !(key.seconds > scene.camera_path.back().seconds)) {
      item["t"].fail("expected more seconds than in the previous keyframe");
    }
    scene.camera_path.push_back(key);
  }
  if (scene.camera_path.empty()) keyframes.fail("expected at least one keyframe");
}

void read_sun(const Field& light, Lights& lights) {
  SunLight sun{light["direction_to_light"].direction(), light["irradiance"].vec3(kLight)};
  if (light.has("angular_diameter_degrees")) {
    sun.angular_diameter =
        light["angular_diameter_degrees"].number({0.0f, 90.0f, "degrees in [0, 90]"});
  }
  lights.suns.push_back(sun);
}

void read_area_rect(const Field& light, Lights& lights) {
  const AreaRect rect{light["center"].vec3(), light["half_u"].vec3(), light["half_v"].vec3(),
                      light["radiance"].vec3(kLight)};
  const glm::vec3 normal = cross(rect.half_u, rect.half_v);
  if (dot(normal, normal) < std::numeric_limits<float>::min()) {
    light["half_v"].fail("expected a vector not parallel to half_u, and an area above 1e-18");
  }
  lights.rects.push_back(rect);
}

void read_light(const Field& light, SceneDescription& scene) {
  const std::string type = light["type"].text();
  if (type == "sun") {
    read_sun(light, scene.lights);
  } else if (type == "sky") {
    scene.lights.sky += light["radiance"].vec3(kLight);
  } else if (type == "area_rect") {
    read_area_rect(light, scene.lights);
  } else if (type == "sphere") {
    scene.lights.spheres.push_back(
        {light["center"].vec3(), light["radius"].number(kLength), light["radiance"].vec3(kLight)});
  } else if (type == "emissive_material") {
    scene.emissive_materials[light["material"].text()] = light["radiance"].vec3(kLight);
  } else {
    // Printed as JSON, so that a line break in the text does not break the message.
    light["type"].fail(
        fmt::format("unknown light {}, expected sun, sky, area_rect, sphere or emissive_material",
                    json(type).dump()));
  }
}

json parse_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot open scene file", path.string()));
  const FloatTrapsOff numbers_may_overflow;
  try {
    return json::parse(in);
  } catch (const json::parse_error& error) {
    throw std::runtime_error(
        fmt::format("{}: broken JSON at byte {}", short_name(path), error.byte));
  } catch (const json::out_of_range&) {
    throw std::runtime_error(
        fmt::format("{}: broken JSON: a number exceeds the range of double", short_name(path)));
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
  if (root.has("exposure")) scene.exposure = root["exposure"].number(kExposure);
  if (root.has("thin_glass_materials")) {
    for (const Field& name : root["thin_glass_materials"].items()) {
      scene.thin_glass_materials.push_back(name.text());
    }
  }
  if (root.has("environment")) {
    const Field environment = root["environment"];
    scene.environment = path.parent_path() / environment["file"].text();
    if (environment.has("scale")) {
      scene.environment_scale = environment["scale"].number(kLight);
    }
  }
  return scene;
}

}  // namespace eigenlight
