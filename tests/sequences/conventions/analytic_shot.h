// A shot whose truth is known: a room with a textured floor, walls, a sphere at rest and one that
// moves, under a camera that moves and turns.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "frame/camera.h"
#include "sequences/conventions/raw_guides.h"

namespace eigenlight {

struct AnalyticShot {
  Extent extent{160, 90};
  bool has_back_wall = true;  // else sky
  bool has_spheres = true, has_textures = true;
  float pace = 1.0f;  // of camera and sphere
  bool only_vertical = false;
  float fov = 60.0f;

  [[nodiscard]] Camera camera(int frame) const {
    const float t = pace * static_cast<float>(frame);
    if (only_vertical) {
      const glm::vec3 eye(0.3f, 1.2f + 0.06f * t, -4.0f);
      return look_at(eye, eye + glm::vec3(0.0f, 0.0f, 1.0f), {0, 1, 0}, fov, extent);
    }
    const glm::vec3 eye(0.3f + 0.07f * t, 1.3f + 0.03f * std::sin(1.3f * t), -4.0f + 0.09f * t);
    return look_at(eye, {0.2f - 0.05f * t, 0.9f + 0.05f * t, 2.0f}, {0, 1, 0}, fov, extent);
  }

  // What is seen at a pixel.
  struct Hit {
    float depth = std::numeric_limits<float>::infinity();
    glm::vec3 position{0.0f}, normal{0.0f}, albedo{0.0f};
    bool moves = false;
  };

  [[nodiscard]] glm::vec3 moving_center(int frame) const {
    const float t = pace * static_cast<float>(frame);
    return {-0.9f + 0.11f * t, 0.7f + (only_vertical ? 0.0f : 0.04f * t), 0.4f};
  }

  [[nodiscard]] Hit hit(int frame, int x, int y) const {
    const Camera view = camera(frame);
    const glm::vec3 ray =
        glm::transpose(view.world_to_view) *
        view.pixel_to_view({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    Hit best;
    hit_plane(view.eye, ray, {0, 1, 0}, 0.0f, best);
    hit_plane(view.eye, ray, {1, 0, 0}, -2.5f, best);
    hit_plane(view.eye, ray, {-1, 0, 0}, -2.5f, best);
    if (has_back_wall) hit_plane(view.eye, ray, {0, 0, -1}, -5.0f, best);
    if (has_spheres) {
      hit_sphere(view.eye, ray, {0.9f, 0.6f, 1.0f}, 0.6f, false, best);
      if (!only_vertical) hit_sphere(view.eye, ray, moving_center(frame), 0.5f, true, best);
    }
    return best;
  }

  /// Truth in our convention; 1e10 in the background. Motion has four channels: to the previous
  /// frame, and from the next one to this one, both x right and y down, earlier minus later.
  [[nodiscard]] RawGuides frame(int index) const {
    RawGuides guides;
    guides.frame = index;
    guides.camera = camera(index);
    guides.depth = Plane<float>(extent);
    guides.normal = make_planes<3>(extent);
    guides.albedo = make_planes<3>(extent);
    guides.position = make_planes<3>(extent);
    for (int c = 0; c < 4; ++c) guides.motion.emplace_back(extent);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) fill(guides, x, y);
    }
    return guides;
  }

 private:
  void fill(RawGuides& guides, int x, int y) const {
    const Hit found = hit(guides.frame, x, y);
    guides.depth(x, y) = std::isfinite(found.depth) ? found.depth : 1e10f;
    if (!std::isfinite(found.depth)) return;
    for (int c = 0; c < 3; ++c) {
      guides.normal[c](x, y) = found.normal[c];
      guides.albedo[c](x, y) = found.albedo[c];
      guides.position[c](x, y) = found.position[c];
    }
    const glm::vec2 before = pixel_in(guides.frame - 1, guides.frame, found);
    const glm::vec2 here = pixel_in(guides.frame, guides.frame, found);
    const glm::vec2 after = pixel_in(guides.frame + 1, guides.frame, found);
    for (int c = 0; c < 2; ++c) {
      guides.motion[static_cast<std::size_t>(c)](x, y) = before[c] - here[c];
      guides.motion[static_cast<std::size_t>(2 + c)](x, y) = here[c] - after[c];
    }
  }

  [[nodiscard]] glm::vec2 pixel_in(int other, int frame, const Hit& found) const {
    const Camera view = camera(other);
    const glm::vec3 moved =
        found.moves ? moving_center(other) - moving_center(frame) : glm::vec3(0.0f);
    return view.view_to_pixel(view.to_view(found.position + moved));
  }

  [[nodiscard]] glm::vec3 texture(const glm::vec3& place, const glm::vec3& tint) const {
    if (!has_textures) return tint;
    const glm::vec3 cell = glm::floor(place * 2.5f + 0.01f);
    auto key = static_cast<std::uint32_t>(static_cast<int>(cell.x) * 73856093 ^
                                          static_cast<int>(cell.y) * 19349663 ^
                                          static_cast<int>(cell.z) * 83492791);
    key ^= key >> 13;
    key *= 0x5bd1e995u;
    return tint * (0.35f + 0.65f * static_cast<float>(key >> 24) / 255.0f);
  }

  void hit_plane(const glm::vec3& eye, const glm::vec3& ray, const glm::vec3& normal, float offset,
                 Hit& best) const {
    const float slope = glm::dot(normal, ray);
    if (slope >= -1e-6f) return;
    const float depth = (offset - glm::dot(normal, eye)) / slope;
    if (depth <= 0.0f || depth >= best.depth) return;
    const glm::vec3 place = eye + depth * ray;
    if (!has_back_wall && place.y > 1.1f) return;  // low walls below the sky
    best = {depth, place, normal, texture(place, glm::abs(normal) * 0.5f + 0.3f), false};
  }

  void hit_sphere(const glm::vec3& eye, const glm::vec3& ray, const glm::vec3& center, float radius,
                  bool moves, Hit& best) const {
    const glm::vec3 to = eye - center;
    const float a = glm::dot(ray, ray), b = glm::dot(ray, to);
    const float inside = b * b - a * (glm::dot(to, to) - radius * radius);
    if (inside <= 0.0f) return;
    const float depth = (-b - std::sqrt(inside)) / a;
    if (depth <= 0.0f || depth >= best.depth) return;
    const glm::vec3 place = eye + depth * ray;
    best = {
        depth, place, (place - center) / radius,
        texture(place - center, moves ? glm::vec3(0.8f, 0.2f, 0.2f) : glm::vec3(0.2f, 0.3f, 0.8f)),
        moves};
  }
};

/// Rounds to half's 11 significant bits.
inline void round_to_half(Plane<float>& plane) {
  for (int y = 0; y < plane.height(); ++y) {
    for (int x = 0; x < plane.width(); ++x) {
      int exponent = 0;
      const float mantissa = std::frexp(plane(x, y), &exponent);
      plane(x, y) = std::ldexp(std::nearbyint(mantissa * 2048.0f), exponent - 11);
    }
  }
}

/// Noise of a few samples a pixel on normals and albedo, and half's rounding of everything.
inline void spoil(RawGuides& guides, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0f, 0.05f);
  for (Planes<3>* planes : {&guides.normal, &guides.albedo}) {
    for (Plane<float>& plane : *planes) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) plane(x, y) += noise(random);
      }
      round_to_half(plane);
    }
  }
  for (Plane<float>& plane : guides.position) round_to_half(plane);
  for (Plane<float>& plane : guides.motion) round_to_half(plane);
  round_to_half(guides.depth);
}

inline void scale(Plane<float>& plane, double factor) {
  for (int y = 0; y < plane.height(); ++y) {
    for (int x = 0; x < plane.width(); ++x) {
      plane(x, y) = static_cast<float>(plane(x, y) * factor);
    }
  }
}

}  // namespace eigenlight
