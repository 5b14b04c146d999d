#include "render/lights/light_set.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "render/lights/distribution.h"

namespace eigenlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kBelowOne = 0x1.fffffep-1f;

// Selects one of several weights that arrive one by one, and keeps the rest of `u` for reuse.
class Picker {
 public:
  Picker(float u, float total) : u_(u * total), total_(total) {}

  /// Returns true for exactly one of the weights that add up to the total.
  [[nodiscard]] bool take(float weight) {
    if (!(weight > 0.0f)) return false;
    last_ = weight;
    if (u_ < weight) return true;
    u_ -= weight;
    return false;
  }
  [[nodiscard]] float probability() const { return last_ / total_; }
  [[nodiscard]] float remainder() const { return std::clamp(u_ / last_, 0.0f, kBelowOne); }

 private:
  float u_, total_;
  float last_ = 1.0f;
};

float half_angle(const SunLight& sun) { return 0.5f * sun.angular_diameter * kPi / 180.0f; }

void divide(std::optional<LightSample>& sample, float probability) {
  if (!sample) return;
  sample->value /= probability;
  sample->pdf *= probability;
}

}  // namespace

LightSet::LightSet(const Scene& scene, const EmbreeScene& geometry)
    : scene_(&scene), geometry_(&geometry), environment_(scene.environment) {
  for (const Material& material : scene.materials) {
    if (material.emission != glm::vec3(0.0f)) has_emissive_materials_ = true;
  }
}

void LightSet::update(const Lights& lights) {
  lights_ = lights;
  disks_.clear();
  for (const SunLight& sun : lights.suns) {
    const float sine = std::sin(0.5f * half_angle(sun));
    // 1 - cos a = 2 sin^2(a/2) keeps its digits for small angles.
    disks_.push_back({std::sin(half_angle(sun)), 2.0f * sine * sine});
  }
  const auto poses = geometry_->transforms();
  if (std::equal(poses.begin(), poses.end(), emitter_poses_.begin(), emitter_poses_.end())) return;
  // The order of the table follows the scene, so that samples depend on the poses only.
  if (emitter_poses_.empty() || !emitters_.empty()) emitters_ = EmitterTable(*scene_, *geometry_);
  emitter_poses_.assign(poses.begin(), poses.end());
}

float LightSet::sun_estimate(std::size_t index, const glm::vec3& normal) const {
  const SunLight& sun = lights_.suns[index];
  // The disk can reach above the horizon while its center is below.
  const float cosine = glm::dot(sun.to_light, normal) + disks_[index].sine;
  return luminance(sun.irradiance) * std::max(cosine, 0.0f);
}

float LightSet::environment_estimate() const {
  if (environment_.is_black()) return 0.0f;
  // The mean irradiance over all normals is a quarter of the integral of radiance over directions.
  return 0.25f * environment_.power() * lights_.environment_scale;
}

float LightSet::emitters_estimate(const glm::vec3& from) const {
  if (emitters_.empty()) return 0.0f;
  const glm::vec3 to_center = emitters_.center() - from;
  const float distance2 = glm::dot(to_center, to_center);
  return emitters_.power() * luminance(lights_.emissive_scale) /
         (distance2 + emitters_.radius() * emitters_.radius());
}

float LightSet::local_total(const glm::vec3& from) const {
  float total = environment_estimate() + emitters_estimate(from);
  for (const AreaRect& rect : lights_.rects) total += estimate_irradiance(rect, from);
  for (const SphereLight& sphere : lights_.spheres) total += estimate_irradiance(sphere, from);
  return total;
}

bool LightSet::has_local() const {
  return !environment_.is_black() || !emitters_.empty() || !lights_.rects.empty() ||
         !lights_.spheres.empty();
}

bool LightSet::has_visible_surfaces() const {
  return has_emissive_materials_ || !lights_.rects.empty() || !lights_.spheres.empty();
}

bool LightSet::has_visible_lights() const {
  return has_visible_surfaces() || !environment_.is_black() || lights_.sky != glm::vec3(0.0f);
}

std::optional<LightSample> LightSet::sample_sun(const glm::vec3& normal, const glm::vec2& u) const {
  float total = 0.0f;
  for (std::size_t i = 0; i < disks_.size(); ++i) total += sun_estimate(i, normal);
  if (!(total > 0.0f)) return std::nullopt;
  Picker picker(u.x, total);
  for (std::size_t i = 0; i < disks_.size(); ++i) {
    if (!picker.take(sun_estimate(i, normal))) continue;
    const SunLight& sun = lights_.suns[i];
    const float one_minus_cosine = disks_[i].one_minus_cosine;
    const glm::vec3 direction =
        sample_cone(sun.to_light, one_minus_cosine, {picker.remainder(), u.y});
    // Irradiance of the disk is radiance * pi sin^2 a, and its density is 1 / (2 pi (1 - cos a)).
    // Hence radiance / density = irradiance * 2 / (1 + cos a), which also holds for a = 0.
    const float value = 2.0f / (2.0f - one_minus_cosine) / picker.probability();
    return LightSample{direction, kInfinity, sun.irradiance * value, kInfinity};
  }
  return std::nullopt;
}

template <typename Shape>
std::optional<LightSample> LightSet::sample_one(const Shape& shape, const glm::vec3& from,
                                                const glm::vec2& u) const {
  const ShapeSample s = sample_shape(shape, from, u);
  if (!(s.pdf > 0.0f)) return std::nullopt;
  return LightSample{s.direction, s.distance, shape.radiance / s.pdf, s.pdf};
}

std::optional<LightSample> LightSet::sample_emitters(const glm::vec3& from, float pick,
                                                     const glm::vec2& u) const {
  const EmitterTable::Sample s = emitters_.sample(pick, u);
  const float distance = glm::length(s.position - from);
  if (!(distance > 0.0f)) return std::nullopt;
  const glm::vec3 direction = (s.position - from) / distance;
  const float cosine = std::abs(glm::dot(direction, s.normal));
  if (!(cosine > 0.0f)) return std::nullopt;
  const float pdf = s.pdf * distance * distance / cosine;
  return LightSample{direction, distance, emitted(s.emission, direction) / pdf, pdf};
}

std::optional<LightSample> LightSet::sample_environment(const glm::vec2& u) const {
  const EnvironmentLight::Sample s = environment_.sample(u);
  if (!(s.pdf > 0.0f)) return std::nullopt;
  const glm::vec3 radiance = environment_.radiance(s.direction) * lights_.environment_scale;
  return LightSample{s.direction, kInfinity, radiance / s.pdf, s.pdf};
}

std::optional<LightSample> LightSet::sample_local(const glm::vec3& from, float pick,
                                                  const glm::vec2& u) const {
  const float total = local_total(from);
  if (!(total > 0.0f)) return std::nullopt;
  Picker picker(pick, total);
  std::optional<LightSample> sample;
  const auto choose = [&] {  // the same order as in local_total()
    if (picker.take(environment_estimate())) return sample_environment(u);
    if (picker.take(emitters_estimate(from))) return sample_emitters(from, picker.remainder(), u);
    for (const AreaRect& rect : lights_.rects) {
      if (picker.take(estimate_irradiance(rect, from))) return sample_one(rect, from, u);
    }
    for (const SphereLight& sphere : lights_.spheres) {
      if (picker.take(estimate_irradiance(sphere, from))) return sample_one(sphere, from, u);
    }
    return std::optional<LightSample>();  // rounding: the weights add up to slightly less
  };
  sample = choose();
  divide(sample, picker.probability());
  return sample;
}

glm::vec3 LightSet::background(const glm::vec3& direction) const {
  return lights_.sky + lights_.environment_scale * environment_.radiance(direction);
}

glm::vec3 LightSet::background(const glm::vec3& from, const glm::vec3& direction, float pdf) const {
  if (environment_.is_black()) return lights_.sky;
  const float probability = environment_estimate() / local_total(from);
  const float other = probability > 0.0f ? probability * environment_.pdf(direction) : 0.0f;
  return lights_.sky +
         power_heuristic(pdf, other) * lights_.environment_scale * environment_.radiance(direction);
}

std::optional<ShapeHit> LightSet::intersect(const Ray& ray) const {
  std::optional<ShapeHit> closest;
  Ray rest = ray;
  std::uint32_t index = 0;
  const auto visit = [&](const auto& shape) {
    if (const std::optional<float> t = eigenlight::intersect(shape, rest)) {
      closest = ShapeHit{*t, index, shape.radiance};
      rest.t_max = *t;
    }
    ++index;
  };
  for (const AreaRect& rect : lights_.rects) visit(rect);
  for (const SphereLight& sphere : lights_.spheres) visit(sphere);
  return closest;
}

float LightSet::pdf(const Ray& ray, const ShapeHit& hit) const {
  const float total = local_total(ray.origin);
  if (!(total > 0.0f)) return 0.0f;
  if (hit.shape < lights_.rects.size()) {
    const AreaRect& rect = lights_.rects[hit.shape];
    return estimate_irradiance(rect, ray.origin) / total * shape_pdf(rect, ray.direction, hit.t);
  }
  const SphereLight& sphere = lights_.spheres[hit.shape - lights_.rects.size()];
  return estimate_irradiance(sphere, ray.origin) / total * shape_pdf(sphere, ray.origin);
}

glm::vec3 LightSet::emitted(const glm::vec3& emission, const glm::vec3& ray_direction) const {
  return emission * lights_.emissive_scale *
         (1.0f - glm::dot(ray_direction, lights_.emissive_tilt));
}

float LightSet::pdf(const Ray& ray, const Hit& hit) const {
  const float estimate = emitters_estimate(ray.origin);
  if (!(estimate > 0.0f)) return 0.0f;
  const float cosine = std::abs(glm::dot(ray.direction, hit.normal));
  if (!(cosine > 0.0f)) return 0.0f;
  return estimate / local_total(ray.origin) * emitters_.pdf(hit.instance) * hit.t * hit.t / cosine;
}

}  // namespace eigenlight
