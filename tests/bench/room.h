// A furnished room seen by a camera that walks in a small circle: frames without a renderer.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "frame/frame.h"
#include "frame/random.h"
#include "frame/tiles.h"

namespace eigenlight {

/// Axis-aligned boxes, hit in closed form. y is up. The room is hollow, its skylight open.
class Room {
 public:
  struct Hit {
    float distance = std::numeric_limits<float>::infinity();  ///< +inf: through the skylight
    glm::vec3 normal{0.0f};
    std::uint32_t id = 0;
  };

  [[nodiscard]] static Hit trace(const glm::vec3& eye, const glm::vec3& direction) {
    Hit hit;
    for (std::uint32_t i = 0; i < kFurniture.size(); ++i) {
      const auto [enter, leave] = slabs(kFurniture[i], eye, direction);
      const float near = largest(enter);
      if (near > 0.0f && near <= smallest(leave) && near < hit.distance) {
        hit = {near, face(enter, near, direction), i + 2};
      }
    }
    if (hit.id != 0) return hit;
    const glm::vec3 leave = slabs(kWalls, eye, direction)[1];
    const float wall = smallest(leave);
    const glm::vec3 point = eye + wall * direction;
    const bool skylight = wall == leave.y && direction.y > 0.0f && std::abs(point.x) < 1.5f &&
                          std::abs(point.z - 1.0f) < 2.0f;
    if (!skylight) hit = {wall, face(leave, wall, direction), 1};
    return hit;
  }

  /// Indirect light over albedo: smooth in space, rising and falling over the frames of a lap.
  [[nodiscard]] static glm::vec3 light(const glm::vec3& point, const glm::vec3& normal,
                                       float phase) {
    const float sun = 1.0f + 0.3f * std::sin(phase + 0.5f * point.x);
    const float wave = std::sin(0.9f * point.x) * std::cos(0.7f * point.z + 0.4f * point.y);
    const float base = 0.4f + 0.2f * wave + 0.1f * normal.y;
    return base * sun * glm::vec3(1.0f, 0.8f + 0.05f * point.y, 0.7f);
  }

 private:
  struct Box {
    glm::vec3 low, high;
  };
  static constexpr Box kWalls{{-4.0f, 0.0f, -5.0f}, {4.0f, 3.0f, 5.0f}};
  static constexpr std::array<Box, 7> kFurniture{{{{-2.6f, 0.0f, 0.2f}, {-2.1f, 3.0f, 0.7f}},
                                                  {{1.8f, 0.0f, -0.6f}, {2.3f, 3.0f, -0.1f}},
                                                  {{-1.2f, 0.7f, 1.4f}, {1.2f, 0.8f, 2.6f}},
                                                  {{-1.1f, 0.0f, 1.5f}, {-1.0f, 0.7f, 1.6f}},
                                                  {{1.0f, 0.0f, 1.5f}, {1.1f, 0.7f, 1.6f}},
                                                  {{-0.3f, 0.8f, 1.8f}, {0.2f, 1.3f, 2.2f}},
                                                  {{2.4f, 0.0f, 3.0f}, {3.8f, 1.1f, 4.6f}}}};

  static float largest(const glm::vec3& v) { return std::max(v.x, std::max(v.y, v.z)); }
  static float smallest(const glm::vec3& v) { return std::min(v.x, std::min(v.y, v.z)); }

  // Where the ray enters and leaves the box along each axis.
  static std::array<glm::vec3, 2> slabs(const Box& box, const glm::vec3& eye,
                                        const glm::vec3& direction) {
    const glm::vec3 a = (box.low - eye) / direction, b = (box.high - eye) / direction;
    return {glm::min(a, b), glm::max(a, b)};
  }
  static glm::vec3 face(const glm::vec3& distances, float distance, const glm::vec3& direction) {
    glm::vec3 normal(0.0f);
    const int axis = distances.x == distance ? 0 : distances.y == distance ? 1 : 2;
    normal[axis] = direction[axis] < 0.0f ? 1.0f : -1.0f;
    return normal;
  }
};

/// What the light of the room does from frame to frame.
enum class RoomLight { kChanging, kSteady };

/// The frames of one lap, ready to be replayed for ever: the last leads on to the first.
struct RoomLap {
  static constexpr int kFrames = 4;
  static constexpr int kSamples = 3;  // Chen 2012

  explicit RoomLap(Extent size, RoomLight kind = RoomLight::kChanging) : extent(size), light(kind) {
    for (int i = 0; i < kFrames; ++i) {
      Frame& frame = frames[static_cast<std::size_t>(i)];
      frame.resize_input(extent);
      frame.index = i;
      frame.previous_index = i - 1;
      frame.spp = kSamples;
      frame.camera = camera(i);
      for_each_tile(stage_tiles(extent), [&](const Rect& tile) { fill(i, tile); });
    }
  }

  /// Gives each frame `layers` layers of light, each with the channels of the one before in turn.
  void repeat_light(int layers) {
    for (Frame& frame : frames) {
      frame.lights.resize(static_cast<std::size_t>(layers));
      for (std::size_t i = 1; i < frame.lights.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
          frame.lights[i].radiance[c] = frame.lights[i - 1].radiance[(c + 1) % 3].clone();
        }
      }
    }
  }

  Extent extent;
  RoomLight light;
  std::vector<Frame> frames = std::vector<Frame>(kFrames);

 private:
  static constexpr float kQuarter = 0.5f * 3.14159265f;  // kFrames of them are a lap

  // Steps of 0.014 a frame: 1 to 3 pixels at 1280x720 for surfaces 3 to 9 away.
  [[nodiscard]] Camera camera(int i) const {
    const float angle = kQuarter * static_cast<float>(i);
    const glm::vec3 eye(0.3f + 0.01f * std::cos(angle), 1.6f + 0.01f * std::sin(angle), -4.2f);
    return look_at(eye, eye + glm::vec3(0.05f, 0.02f, 1.0f), {0, 1, 0}, 60.0f, extent);
  }

  void fill(int i, const Rect& tile) {
    Frame& frame = frames[static_cast<std::size_t>(i)];
    const Camera previous = camera((i + kFrames - 1) % kFrames);
    const float phase = light == RoomLight::kSteady ? 0.0f : kQuarter * static_cast<float>(i);
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const glm::vec3 direction =
            glm::transpose(frame.camera.world_to_view) * frame.camera.pixel_to_view(center);
        const Room::Hit hit = Room::trace(frame.camera.eye, direction);
        // `direction` has z = 1 in view space, so the distance along it is the depth.
        frame.surface.depth(x, y) = hit.distance;
        frame.surface.id(x, y) = hit.id;
        frame.previous_depth(x, y) = hit.distance;
        if (hit.id == 0) continue;
        const glm::vec3 point = frame.camera.eye + hit.distance * direction;
        const glm::vec3 before = previous.to_view(point);
        const glm::vec2 motion = previous.view_to_pixel(before) - center;
        frame.previous_depth(x, y) = before.z;
        frame.motion[0](x, y) = motion.x;
        frame.motion[1](x, y) = motion.y;
        const glm::vec3 radiance = Room::light(point, hit.normal, phase);
        for (int c = 0; c < 3; ++c) {
          const auto plane = static_cast<std::size_t>(c);
          frame.surface.normal[plane](x, y) = hit.normal[c];
          frame.surface.albedo[plane](x, y) = 0.3f + 0.1f * static_cast<float>(hit.id % 5);
          frame.lights[0].radiance[plane](x, y) = radiance[c] * noise(i, x, y);
        }
      }
    }
  }

  // Mean of kSamples values of an exponential distribution: mean 1, as skewed as path tracing.
  [[nodiscard]] static float noise(int i, int x, int y) {
    float sum = 0.0f;
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      const auto bits = hash_key(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(x),
                                 static_cast<std::uint32_t>(y), s);
      sum -= std::log(1.0f - to_unit(bits));
    }
    return sum / static_cast<float>(kSamples);
  }
};

}  // namespace eigenlight
