// Random frames of fixed seeds: tilted planes seen by a moving camera, with sky and invalid light.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "frame/frame.h"
#include "frame/random.h"
#include "reproject/basis_field.h"

namespace eigenlight {

/// Uniform numbers: the same for the same seed, pixel and count of calls.
class PixelRandom {
 public:
  PixelRandom(std::uint32_t seed, int x, int y)
      : key_(hash_key(seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))) {}
  [[nodiscard]] float uniform() { return to_unit(hash_key(key_, dimension_++)); }
  [[nodiscard]] float between(float low, float high) { return low + (high - low) * uniform(); }

 private:
  std::uint32_t key_, dimension_ = 0;
};

struct RandomFrameOptions {
  Extent extent;
  std::uint32_t seed = 1;
  bool sky = true;         ///< about one region in eight shows no surface
  bool disturbed = true;   ///< some motion, depth and normals are wrong or not finite
  bool non_finite = true;  ///< one indirect value in fifty is NaN or Inf
  float light = 1.0f;      ///< scale of indirect light
};

namespace random_frames_detail {

struct Surface {
  glm::vec3 normal;
  float offset;  // normal . X
};

inline Surface surface(std::uint32_t id) {
  const std::array<glm::vec3, 3> tilts{{{0.3f, 0.1f, -1.0f}, {-0.2f, 0.4f, -1.0f}, {0, 0, -1}}};
  const glm::vec3 normal = glm::normalize(tilts[id % 3]);
  return {normal, glm::dot(normal, glm::vec3(0, 0, 4.0f + 0.5f * static_cast<float>(id)))};
}

inline std::uint32_t id_at(const RandomFrameOptions& options, int x, int y) {
  const auto region = hash_key(options.seed, static_cast<std::uint32_t>(x / 9),
                               static_cast<std::uint32_t>(y / 6), 77u);
  return options.sky && region % 8 == 0 ? 0u : 1u + region % 5;
}

inline float depth_along(const Camera& camera, const Surface& surface, const glm::vec3& ray) {
  const glm::vec3 direction = camera.to_world(ray) - camera.eye;
  return (surface.offset - glm::dot(surface.normal, camera.eye)) /
         glm::dot(surface.normal, direction);
}

inline void disturb(PixelRandom& random, Frame& frame, int x, int y) {
  const float kind = random.uniform();
  if (kind < 0.05f) {
    frame.motion[0](x, y) += random.between(-4.0f, 4.0f);
    frame.motion[1](x, y) += random.between(-4.0f, 4.0f);
  } else if (kind < 0.07f) {
    frame.motion[kind < 0.06f](x, y) = std::numeric_limits<float>::quiet_NaN();
  } else if (kind < 0.09f) {
    frame.motion[kind < 0.08f](x, y) = -std::numeric_limits<float>::infinity();
  } else if (kind < 0.11f) {
    frame.previous_depth(x, y) = kind < 0.10f ? std::numeric_limits<float>::quiet_NaN()
                                              : std::numeric_limits<float>::infinity();
  } else if (kind < 0.15f) {
    frame.previous_depth(x, y) *= 1.06f;
  } else if (kind < 0.19f) {
    const glm::vec3 bent =
        glm::normalize(glm::vec3(frame.surface.normal[0](x, y), frame.surface.normal[1](x, y),
                                 frame.surface.normal[2](x, y)) +
                       glm::vec3(random.between(-0.7f, 0.7f), random.between(-0.7f, 0.7f), 0.0f));
    for (int c = 0; c < 3; ++c) frame.surface.normal[static_cast<std::size_t>(c)](x, y) = bent[c];
  }
}

inline void fill_light(const RandomFrameOptions& options, PixelRandom& random, Frame& frame, int x,
                       int y) {
  const bool shown = frame.surface.id(x, y) != 0;
  for (auto& plane : frame.lights[0].radiance) {
    plane(x, y) = shown ? options.light * random.between(0.0f, 2.0f) : 0.0f;
  }
  const float kind = random.uniform();
  if (!shown || !options.non_finite || kind > 0.02f) return;
  frame.lights[0].radiance[static_cast<std::size_t>(kind * 150.0f) % 3](x, y) =
      kind < 0.01f ? std::numeric_limits<float>::quiet_NaN()
                   : std::numeric_limits<float>::infinity();
}

}  // namespace random_frames_detail

/// The camera of frame `index`, for any extent: turned in all three axes and moving slowly.
[[nodiscard]] inline Camera random_camera(Extent extent, int index) {
  const float t = static_cast<float>(index);
  return look_at({0.3f + 0.02f * t, -0.2f + 0.01f * t, 0.1f + 0.03f * t}, {0.5f, 0.3f, 5.0f},
                 {0.2f, 1.0f, 0.1f}, 50.0f, extent);
}

/// Frame `index` of a still scene of tilted planes: exact motion and previous depth with respect to
/// frame index - 1, unless disturbed.
[[nodiscard]] inline Frame make_random_frame(const RandomFrameOptions& options, int index) {
  namespace detail = random_frames_detail;
  Frame frame;
  frame.resize(options.extent);
  frame.index = index;
  frame.previous_index = index - 1;
  frame.spp = 3;
  frame.camera = random_camera(options.extent, index);
  const Camera before = random_camera(options.extent, index - 1);
  for (int y = 0; y < options.extent.height; ++y) {
    for (int x = 0; x < options.extent.width; ++x) {
      PixelRandom random(hash_key(options.seed, static_cast<std::uint32_t>(index)), x, y);
      const std::uint32_t id = detail::id_at(options, x, y);
      const glm::vec2 pixel = glm::vec2(x, y) + 0.5f;
      frame.surface.id(x, y) = id;
      frame.surface.depth(x, y) = std::numeric_limits<float>::infinity();
      frame.previous_depth(x, y) = std::numeric_limits<float>::infinity();
      if (id != 0) {
        const detail::Surface surface = detail::surface(id);
        const glm::vec3 ray = frame.camera.pixel_to_view(pixel);
        const float depth = detail::depth_along(frame.camera, surface, ray);
        const glm::vec3 view = before.to_view(frame.camera.to_world(ray * depth));
        const glm::vec2 motion = before.view_to_pixel(view) - pixel;
        frame.surface.depth(x, y) = depth;
        frame.previous_depth(x, y) = view.z;
        for (int c = 0; c < 3; ++c) {
          const auto plane = static_cast<std::size_t>(c);
          frame.surface.normal[plane](x, y) = surface.normal[c];
          frame.surface.albedo[plane](x, y) = random.uniform();
          if (c < 2) frame.motion[plane](x, y) = motion[c];
        }
        if (options.disturbed) detail::disturb(random, frame, x, y);
      }
      detail::fill_light(options, random, frame, x, y);
    }
  }
  return frame;
}

/// Uniform values in [low, high).
[[nodiscard]] inline Plane<float> random_plane(Extent extent, std::uint32_t seed, float low,
                                               float high) {
  Plane<float> plane(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      plane(x, y) = PixelRandom(seed, x, y).between(low, high);
    }
  }
  return plane;
}

/// Compares all values and ages, but not the padding at the end of rows.
inline void fill_bases(BasisField& field, float value) {
  const auto [width, height] = field.extent();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int line = 0; line < field.lines(); ++line) field.at(x, y)[kBlock * line] = value;
    }
  }
}

/// V_0 in [0.5, 1.5), further bases in [-0.5, 0.5), ages in [1, 40); one pixel in ten has no
/// history.
[[nodiscard]] inline BasisField random_bases(Extent extent, int bases, std::uint32_t seed) {
  BasisField field(extent, bases);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      PixelRandom random(seed, x, y);
      if (random.uniform() < 0.1f) continue;
      field.age(x, y) = random.between(1.0f, 40.0f);
      for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < bases; ++k) {
          field.value(x, y, c, k) = random.between(-0.5f, 0.5f) + (k == 0 ? 1.0f : 0.0f);
        }
      }
    }
  }
  return field;
}

}  // namespace eigenlight
