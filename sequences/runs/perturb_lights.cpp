#include "sequences/runs/perturb_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace eigenlight {
namespace {

/// The lowest elevation, in degrees, that a sun sweeps around: 5 more than the sweep.
constexpr float kLowestSun = kLightSweep + 5.0f;
/// Share of the lobe in the light of swinging emissive triangles; below 1, so that no direction
/// goes dark.
constexpr float kLobe = 0.8f;

glm::vec3 turned(const glm::vec3& v, float degrees, const glm::vec3& axis) {
  return glm::vec3(glm::rotate(glm::mat4(1.0f), glm::radians(degrees), axis) * glm::vec4(v, 0.0f));
}

/// A unit vector orthogonal to `up`, and to `v` unless `v` is parallel to `up`.
glm::vec3 horizontal(const glm::vec3& up, const glm::vec3& v) {
  for (const glm::vec3& other : {v, glm::vec3(0, 0, 1), glm::vec3(1, 0, 0)}) {
    const glm::vec3 axis = cross(up, other);
    if (dot(axis, axis) > 1e-6f) return normalize(axis);
  }
  return {1, 0, 0};
}

/// `to_light` raised to at least kLowestSun, then by `degrees`.
glm::vec3 swept_sun(const glm::vec3& to_light, const glm::vec3& up, float degrees) {
  const glm::vec3 axis = horizontal(up, to_light);
  const float height =
      glm::degrees(std::asin(std::clamp(dot(normalize(to_light), up), -1.0f, 1.0f)));
  const glm::vec3 ahead = cross(axis, up);
  const float swept = std::max(height, kLowestSun) + degrees;
  return normalize(ahead * std::cos(glm::radians(swept)) + up * std::sin(glm::radians(swept)));
}

float mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3.0f; }

/// Power of all emissive triangles; they emit on both sides: 2 pi A L.
float emissive_power(const Scene& scene) {
  float power = 0.0f;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const float radiance = mean(scene.materials[static_cast<std::size_t>(mesh.material)].emission);
    if (!(radiance > 0.0f)) continue;
    const glm::mat3 linear(instance.to_world);
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::vec3 u = linear * (mesh.positions[t.y] - mesh.positions[t.x]);
      const glm::vec3 v = linear * (mesh.positions[t.z] - mesh.positions[t.x]);
      power += glm::two_pi<float>() * radiance * 0.5f * glm::length(cross(u, v));
    }
  }
  return power;
}

void scale(Lights& lights, MainLight light, float factor) {
  switch (light.kind) {
    case MainLight::Kind::kSuns:
      for (SunLight& sun : lights.suns) sun.irradiance *= factor;
      break;
    case MainLight::Kind::kRect:
      lights.rects[light.index].radiance *= factor;
      break;
    case MainLight::Kind::kSphere:
      lights.spheres[light.index].radiance *= factor;
      break;
    case MainLight::Kind::kEmissive:
      lights.emissive_scale *= factor;
      break;
    case MainLight::Kind::kSky:
      lights.sky *= factor;
      lights.environment_scale *= factor;
      break;
  }
}

}  // namespace

MainLight main_light(const Scene& scene) {
  using Kind = MainLight::Kind;
  MainLight main;
  if (!scene.lights.suns.empty()) return {Kind::kSuns, 0};
  float strongest = 0.0f;
  const auto offer = [&](float power, Kind kind, std::size_t index) {
    if (!(power > strongest)) return;
    strongest = power;
    main = {kind, index};
  };
  for (std::size_t i = 0; i < scene.lights.rects.size(); ++i) {
    const AreaRect& r = scene.lights.rects[i];
    const float area = 4.0f * glm::length(cross(r.half_u, r.half_v));
    offer(glm::pi<float>() * area * mean(r.radiance), Kind::kRect, i);
  }
  for (std::size_t i = 0; i < scene.lights.spheres.size(); ++i) {
    const SphereLight& s = scene.lights.spheres[i];
    const float area = 4.0f * glm::pi<float>() * s.radius * s.radius;
    offer(glm::pi<float>() * area * mean(s.radiance), Kind::kSphere, i);
  }
  offer(emissive_power(scene), Kind::kEmissive, 0);
  return main;
}

LightPerturbation::LightPerturbation(const Scene& scene)
    : rest_(scene.lights), main_(main_light(scene)), up_(normalize(scene.up)) {}

Lights LightPerturbation::at(int frame) const {
  using Kind = MainLight::Kind;
  const int step = ((frame % kLightPeriod) + kLightPeriod) % kLightPeriod;
  const float phase =
      glm::two_pi<float>() * static_cast<float>(step) / static_cast<float>(kLightPeriod);
  const float sweep = kLightSweep * std::sin(phase);
  Lights lights = rest_;
  scale(lights, main_, 1.0f + kLightPulse * std::cos(phase));
  if (main_.kind == Kind::kSuns) {
    for (SunLight& sun : lights.suns) sun.to_light = swept_sun(sun.to_light, up_, sweep);
  } else if (main_.kind == Kind::kRect) {
    AreaRect& rect = lights.rects[main_.index];
    rect.half_v = turned(rect.half_v, sweep, normalize(rect.half_u));
  } else if (main_.kind == Kind::kSphere) {
    SphereLight& sphere = lights.spheres[main_.index];
    const glm::vec3 down = -3.0f * sphere.radius * up_;
    sphere.center += turned(down, sweep, horizontal(up_, {0, 0, 1})) - down;
  } else if (main_.kind == Kind::kEmissive) {
    lights.emissive_tilt = turned(-kLobe * up_, sweep, horizontal(up_, {0, 0, 1}));
  }
  return lights;
}

LightStep::LightStep(const Scene& scene, int frame)
    : before_(scene.lights), after_(scene.lights), frame_(frame) {
  scale(after_, main_light(scene), kLightStep);
}

}  // namespace eigenlight
