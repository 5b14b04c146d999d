#include "sequences/lab/paper_xu2024_uses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "frame/random.h"

namespace eigenlight {
namespace {

// Side of a cube of constant roughness; the scenes are a few meters wide.
constexpr float kCube = 0.7f;
constexpr std::array<float, 2> kRoughness{0.3f, 0.75f};  // sqrt(alpha)
// Largest circle of confusion, and circle per relative distance from the focus, in pixels.
constexpr float kLargestCircle = 32.0f, kCircleScale = 48.0f;
constexpr int kSpheres = 400;
constexpr float kCloudDepth = 5.0f;

struct Lamp {
  glm::vec3 toward, color;
  float sharpness;
};
const std::array<Lamp, 3> kLamps{{{{0.5f, 0.8f, 0.33f}, {9.0f, 7.5f, 5.0f}, 60.0f},
                                  {{-0.7f, 0.5f, 0.5f}, {3.0f, 5.0f, 8.0f}, 30.0f},
                                  {{0.1f, 0.2f, -0.97f}, {6.0f, 2.5f, 1.5f}, 90.0f}}};

glm::vec3 environment(const glm::vec3& toward) {
  glm::vec3 color =
      glm::mix(glm::vec3(0.12f, 0.1f, 0.08f), glm::vec3(0.45f, 0.6f, 0.9f), 0.5f + 0.5f * toward.y);
  for (const Lamp& lamp : kLamps) {
    color += lamp.color *
             std::exp(lamp.sharpness * (glm::dot(toward, glm::normalize(lamp.toward)) - 1.0f));
  }
  return color;
}

glm::vec3 vector_at(const Planes<3>& planes, int x, int y) {
  return {planes[0](x, y), planes[1](x, y), planes[2](x, y)};
}

void set(Planes<3>& planes, int x, int y, const glm::vec3& value) {
  for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)](x, y) = value[c];
}

template <typename Body>
void for_each_surface(const Frame& frame, const Body& body) {
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (frame.surface.id(x, y) != 0) body(x, y);
    }
  }
}

void set_geometry(const Frame& frame, int x, int y, float* attributes) {
  for (std::size_t c = 0; c < 3; ++c) attributes[c] = frame.surface.normal[c](x, y);
  attributes[3] = frame.surface.depth(x, y);
}

// A half vector around `normal`, drawn from GGX (Walter et al. 2007, Eq. 35 and 36).
glm::vec3 half_vector(const glm::vec3& normal, float alpha, float u, float v) {
  const float tangent = alpha * std::sqrt(u / (1.0f - u));
  const float angle = 2.0f * std::numbers::pi_v<float> * v;
  const glm::vec3 side = std::abs(normal.x) > 0.5f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 t = glm::normalize(glm::cross(side, normal)), b = glm::cross(normal, t);
  return glm::normalize(normal + tangent * (std::cos(angle) * t + std::sin(angle) * b));
}

float median_depth(const Frame& frame) {
  std::vector<float> depths;
  for_each_surface(frame, [&](int x, int y) { depths.push_back(frame.surface.depth(x, y)); });
  if (depths.empty()) return 1.0f;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

void compress(const Plane<float>& mask, Planes<3>& light) {
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (!(mask(x, y) > 0.0f)) continue;
      const glm::vec3 v = vector_at(light, x, y);
      set(light, x, y, v / (1.0f + 0.25f * v.x + 0.5f * v.y + 0.25f * v.z));
    }
  }
}

PyramidUse<GlobalIlluminationEdge> diffuse_use(const Frame& frame, const Planes<3>& light,
                                               float exposure) {
  PyramidUse<GlobalIlluminationEdge> use({.blur_radius = kUseRadius}, frame.extent());
  for_each_surface(frame, [&](int x, int y) {
    use.weight(x, y) = 1.0f;
    set_geometry(frame, x, y, use.attributes.at(x, y));
    set(use.signal, x, y, exposure * vector_at(light, x, y));
  });
  compress(use.weight, use.signal);
  return use;
}

PyramidUse<ReflectionEdge> reflection_use(const Frame& frame) {
  PyramidUse<ReflectionEdge> use({}, frame.extent());
  use.edge.geometry.blur_radius = kUseRadius;
  for_each_surface(frame, [&](int x, int y) {
    const glm::vec3 position = vector_at(frame.position, x, y);
    const glm::vec3 normal = vector_at(frame.surface.normal, x, y);
    const glm::vec3 cube = glm::floor(position / kCube);
    const bool odd = std::fmod(std::abs(cube.x + cube.y + cube.z), 2.0f) > 0.5f;
    const float roughness = kRoughness[odd ? 1 : 0];
    const auto number = [&](std::uint32_t n) { return to_unit(hash_key(n, x, y)); };
    const glm::vec3 half = half_vector(normal, roughness * roughness, number(1), number(2));
    use.weight(x, y) = 1.0f;
    set_geometry(frame, x, y, use.attributes.at(x, y));
    use.attributes.at(x, y)[4] = roughness;
    set(use.signal, x, y,
        environment(glm::reflect(glm::normalize(position - frame.camera.eye), half)));
  });
  compress(use.weight, use.signal);
  return use;
}

PyramidUse<DepthOfFieldEdge> depth_of_field_use(const Frame& frame) {
  PyramidUse<DepthOfFieldEdge> use({.sigma = kUseRadius}, frame.extent());
  const float focus = median_depth(frame);
  use.weight.fill(1.0f);
  use.attributes.fill(kLargestCircle);  // the sky
  for (Plane<float>& plane : use.signal) plane.fill(0.6f);
  for_each_surface(frame, [&](int x, int y) {
    const glm::vec3 normal = vector_at(frame.surface.normal, x, y);
    const glm::vec3 view = glm::normalize(frame.camera.eye - vector_at(frame.position, x, y));
    use.attributes(x, y) =
        std::min(kCircleScale * std::abs(1.0f - focus / frame.surface.depth(x, y)), kLargestCircle);
    set(use.signal, x, y,
        vector_at(frame.surface.albedo, x, y) * (0.2f + 0.8f * std::abs(glm::dot(normal, view))));
  });
  return use;
}

PyramidUse<ParticleEdge> particle_use(Extent extent, std::uint32_t seed) {
  // z_p |z_p - z_q| sigma_z is about 1 at the radius of a sphere.
  PyramidUse<ParticleEdge> use({.depth_scale = 0.4f, .blur_radius = kUseRadius}, extent);
  const float radius = static_cast<float>(extent.height) / 16.0f;  // of a sphere, pixels
  const auto number = [&](int sphere, std::uint32_t n) {
    return to_unit(hash_key(seed, sphere, n));
  };
  for (int s = 0; s < kSpheres; ++s) {
    const float angle = 2.0f * std::numbers::pi_v<float> * number(s, 0);
    const float out = std::sqrt(number(s, 1));
    const float cx = static_cast<float>(extent.width) * (0.5f + 0.4f * out * std::cos(angle));
    const float cy = static_cast<float>(extent.height) * (0.5f + 0.4f * out * std::sin(angle));
    const float cz = kCloudDepth + number(s, 2);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const float dx = (static_cast<float>(x) + 0.5f - cx) / radius;
        const float dy = (static_cast<float>(y) + 0.5f - cy) / radius;
        if (dx * dx + dy * dy >= 1.0f) continue;
        // Depth of a sphere of radius 0.25.
        const float z = cz - 0.25f * std::sqrt(1.0f - dx * dx - dy * dy);
        float& own = use.attributes(x, y);
        if (own == 0.0f || z < own) own = z;
      }
    }
  }
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      use.weight(x, y) = use.attributes(x, y) > 0.0f ? 1.0f : 0.0f;
      set(use.signal, x, y, glm::vec3(use.attributes(x, y)));
    }
  }
  return use;
}

Planes<3> lit_particles(const PyramidUse<ParticleEdge>& use, const Planes<3>& depth) {
  const Extent extent = use.weight.extent();
  const float pixel = 0.25f * 16.0f / static_cast<float>(extent.height);
  Planes<3> lit = make_planes<3>(extent);
  const auto slope = [&](int x, int y, int dx, int dy) {
    const auto there = [&](int sx, int sy) {
      return extent.contains(sx, sy) && use.weight(sx, sy) > 0.0f ? depth[0](sx, sy)
                                                                  : depth[0](x, y);
    };
    return (there(x + dx, y + dy) - there(x - dx, y - dy)) / (2.0f * pixel);
  };
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      if (!(use.weight(x, y) > 0.0f)) continue;
      const glm::vec3 normal =
          glm::normalize(glm::vec3(-slope(x, y, 1, 0), -slope(x, y, 0, 1), 1.0f));
      set(lit, x, y,
          glm::vec3(0.1f +
                    0.9f * std::max(glm::dot(normal, glm::vec3(-0.4f, -0.4f, 0.82f)), 0.0f)));
    }
  }
  return lit;
}

}  // namespace eigenlight
