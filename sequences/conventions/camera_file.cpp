#include "sequences/conventions/camera_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

using Json = nlohmann::json;

// No place and no lens is beyond, and float holds its square.
constexpr double kLargest = 1e15;
// Lenses and heights of pictures, in widths: from fisheye to telescope, banners and strips.
constexpr double kShortest = 1e-3, kLongest = 1e4;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& field,
                       const std::string& what) {
  throw BadFile(fmt::format("{}: {}: {}", path.string(), field, what));
}

// matrix[column][row], as glm has them.
glm::dmat4 read_matrix(const std::filesystem::path& path, const std::string& frame,
                       const Json& entry, const char* name) {
  const std::string field = fmt::format("frames.{}.{}", frame, name);
  const auto found = entry.is_object() ? entry.find(name) : entry.end();
  if (!entry.is_object() || found == entry.end()) {
    fail(path, field, "is missing, expected 4 rows of 4 numbers");
  }
  glm::dmat4 matrix(0.0);
  if (!found->is_array() || found->size() != 4) fail(path, field, "expected 4 rows of 4 numbers");
  for (int row = 0; row < 4; ++row) {
    const Json& values = (*found)[static_cast<std::size_t>(row)];
    if (!values.is_array() || values.size() != 4) {
      fail(path, field, fmt::format("row {}: expected 4 numbers", row));
    }
    for (int column = 0; column < 4; ++column) {
      const Json& value = values[static_cast<std::size_t>(column)];
      if (!value.is_number() || std::abs(value.get<double>()) > kLargest) {
        fail(path, field,
             fmt::format("row {}, column {}: expected a number within 1e15", row, column));
      }
      matrix[column][row] = value.get<double>();
    }
  }
  return matrix;
}

// For a picture of width 1; the height follows from square pixels.
Camera to_camera(const std::filesystem::path& path, const std::string& frame,
                 const glm::dmat4& to_world, const glm::dmat4& projection) {
  glm::dvec3 axes[3];
  for (int i = 0; i < 3; ++i) {
    axes[i] = glm::dvec3(to_world[i]);
    const double length = glm::length(axes[i]);
    if (length <= 0.0) fail(path, fmt::format("frames.{}.camera_to_world", frame), "an axis is 0");
    axes[i] /= length;
  }
  for (int i = 0; i < 3; ++i) {
    if (std::abs(glm::dot(axes[i], axes[(i + 1) % 3])) > 1e-3) {
      fail(path, fmt::format("frames.{}.camera_to_world", frame),
           "its first three columns are not perpendicular, expected a rotation");
    }
  }
  const double fx = projection[0][0], fy = projection[1][1];
  if (fx <= 0.0 || fy <= 0.0 || projection[2][3] >= 0.0 || projection[3][3] != 0.0) {
    fail(path, fmt::format("frames.{}.projection", frame),
         "expected a perspective projection (rows x, y, z, w; last row 0 0 -1 0)");
  }
  const double height = fx / fy, w = -projection[2][3];
  const double focal = 0.5 * fx / w;
  const glm::dvec2 center(0.5 * (1.0 - projection[2][0] / w),
                          0.5 * height * (1.0 + projection[2][1] / w));
  // NaN fails as well.
  if (!(focal >= kShortest && focal <= kLongest && height >= kShortest && height <= kLongest &&
        std::abs(center.x) <= kLongest && std::abs(center.y) <= kLongest)) {
    fail(
        path, fmt::format("frames.{}.projection", frame),
        fmt::format("a lens of {:.3g} widths, a picture {:.3g} high, the axis at ({:.3g}, {:.3g}); "
                    "expected lens and height from {} to {}, the axis within {} widths",
                    focal, height, center.x, center.y, kShortest, kLongest, kLongest));
  }
  Camera camera;
  camera.eye = glm::vec3(to_world[3]);
  camera.world_to_view = glm::mat3(glm::transpose(glm::dmat3(axes[0], -axes[1], -axes[2])));
  camera.focal = static_cast<float>(focal);
  camera.center = glm::vec2(center);
  return camera;
}

int frame_number(const std::filesystem::path& path, const std::string& text) {
  int frame = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame);
  if (error != std::errc() || end != text.data() + text.size()) {
    fail(path, fmt::format("frames.{}", text), "expected a frame number as name");
  }
  return frame;
}

Json parse(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw std::runtime_error(fmt::format("{}: cannot be read", path.string()));
  Json json;
  try {
    json = Json::parse(stream);
  } catch (const Json::exception& error) {
    fail(path, "JSON", error.what());
  }
  if (!json.is_object()) fail(path, "JSON", "expected an object with a field 'frames'");
  if (!json.contains("frames") || !json["frames"].is_object()) {
    fail(path, "frames", "is missing, expected an object with a camera for each frame");
  }
  return json;
}

}  // namespace

CameraFile::CameraFile(std::filesystem::path path) : path_(std::move(path)) {
  const Json json = parse(path_);
  for (const auto& [name, entry] : json["frames"].items()) {
    const glm::dmat4 to_world = read_matrix(path_, name, entry, "camera_to_world");
    const glm::dmat4 projection = read_matrix(path_, name, entry, "projection");
    const double aspect = projection[0][0] > 0.0 ? projection[1][1] / projection[0][0] : 0.0;
    frames_[frame_number(path_, name)] = {to_camera(path_, name, to_world, projection), aspect};
  }
}

std::optional<Camera> CameraFile::camera(int frame, Extent extent) const {
  const auto found = frames_.find(frame);
  if (found == frames_.end()) return std::nullopt;
  const double aspect = static_cast<double>(extent.width) / extent.height;
  if (std::abs(aspect / found->second.aspect - 1.0) > 0.01) {
    fail(path_, fmt::format("frames.{}.projection", frame),
         fmt::format("is for pictures of aspect {:.4g}, but the frames are {}x{} ({:.4g})",
                     found->second.aspect, extent.width, extent.height, aspect));
  }
  Camera camera = found->second.camera;
  const auto width = static_cast<float>(extent.width);
  camera.focal *= width;
  camera.center *= width;
  return camera;
}

}  // namespace eigenlight
