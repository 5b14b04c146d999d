#include "render/paths/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace eigenlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Shadow rays end before the light by this fraction of the distance, so as not to hit it. It is far
// above the rounding of a distance and far below any gap that matters.
constexpr float kShort = 1e-4f;

}  // namespace

// Returns false if the direction points below the geometric surface, which can happen around an
// interpolated normal. Such rays carry no light; light sampling rejects them too.
bool PathTracer::sample_ray(const SurfacePoint& point, Sampler& sampler, Bounce& bounce) const {
  const glm::vec2 u = sampler.next_2d();
  const float radius = std::sqrt(u.x);
  const float phi = 2.0f * kPi * u.y;
  const float height = std::sqrt(1.0f - u.x);
  const glm::vec3 local(radius * std::cos(phi), radius * std::sin(phi), height);
  bounce.ray.origin = point.origin;
  bounce.ray.direction = from_local_frame(point.normal, local);
  bounce.pdf = height / kPi;
  return glm::dot(bounce.ray.direction, point.geometric) > 0.0f && bounce.pdf > 0.0f;
}

void PathTracer::trace(Bounce& bounce, std::int64_t& rays) const {
  ++rays;
  bounce.hit = world_.geometry.intersect_quad(bounce.ray);
  Ray rest = bounce.ray;
  if (bounce.hit) rest.t_max = bounce.hit->t;
  bounce.shape = world_.lights.intersect(rest);
  if (bounce.shape) {
    bounce.hit.reset();
    rest.t_max = bounce.shape->t;
  }
  bounce.tint = world_.geometry.glass_tint(rest);
}

// Radiance that lights emit along the ray, times the power heuristic against light sampling.
glm::vec3 PathTracer::weighted_emission(const Bounce& bounce) const {
  const LightSet& lights = world_.lights;
  if (bounce.shape) {
    return power_heuristic(bounce.pdf, lights.pdf(bounce.ray, *bounce.shape)) *
           bounce.shape->radiance;
  }
  if (!bounce.hit) return lights.background(bounce.ray.origin, bounce.ray.direction, bounce.pdf);
  const glm::vec3& emission = world_.surfaces.emission(*bounce.hit);
  if (emission == glm::vec3(0.0f)) return emission;
  return power_heuristic(bounce.pdf, lights.pdf(bounce.ray, *bounce.hit)) *
         lights.emitted(emission, bounce.ray.direction);
}

// Light that the ray receives from emitters only, for rays that do not go on. If the sky is the
// only light that a ray can meet, an occlusion test suffices, at a third of the cost.
glm::vec3 PathTracer::emission_along(Bounce& bounce, std::int64_t& rays) const {
  if (!world_.lights.has_visible_lights()) return glm::vec3(0.0f);
  if (world_.lights.has_visible_surfaces()) {
    trace(bounce, rays);
  } else {
    ++rays;
    if (world_.geometry.occluded(bounce.ray)) return glm::vec3(0.0f);
    bounce.hit.reset();
    bounce.shape.reset();
    bounce.tint = world_.geometry.glass_tint(bounce.ray);
  }
  return bounce.tint * weighted_emission(bounce);
}

glm::vec3 PathTracer::unoccluded_light(const SurfacePoint& point, const LightSample& sample,
                                       const ShadowRayOptions& options, std::int64_t& rays) const {
  const float cosine = glm::dot(sample.direction, point.normal);
  if (!(cosine > 0.0f) || !(glm::dot(sample.direction, point.geometric) > 0.0f)) {
    return glm::vec3(0.0f);
  }
  const Ray ray{point.origin, sample.direction, 0.0f, sample.distance * (1.0f - kShort),
                options.quick};
  ++rays;
  if (world_.geometry.occluded(ray) || world_.lights.occluded(ray)) return glm::vec3(0.0f);
  const float weight = power_heuristic(sample.pdf, options.weight_against * cosine / kPi);
  return weight * cosine / kPi * sample.value * world_.geometry.glass_tint(ray);
}

// Light sampling: light that reaches the point directly from one sun.
glm::vec3 PathTracer::sample_sun(const SurfacePoint& point, Sampler& sampler, bool quick,
                                 std::int64_t& rays) const {
  if (!world_.lights.has_suns()) return glm::vec3(0.0f);
  const auto sample = world_.lights.sample_sun(point.normal, sampler.next_2d());
  return sample ? unoccluded_light(point, *sample, {0.0f, quick}, rays) : glm::vec3(0.0f);
}

// The same of one local light.
glm::vec3 PathTracer::sample_local(const SurfacePoint& point, Sampler& sampler, bool quick,
                                   std::int64_t& rays) const {
  if (!world_.lights.has_local()) return glm::vec3(0.0f);
  const float pick = sampler.next_1d();
  const auto sample = world_.lights.sample_local(point.origin, pick, sampler.next_2d());
  return sample ? unoccluded_light(point, *sample, {1.0f, quick}, rays) : glm::vec3(0.0f);
}

bool PathTracer::reaches(const SurfacePoint& point, const std::optional<LightSample>& sample,
                         std::int64_t& rays) const {
  if (!sample) return false;
  const glm::vec3 light = unoccluded_light(point, *sample, {}, rays);
  return std::max({light.x, light.y, light.z}) > 0.0f;
}

bool PathTracer::sees_sun(const SurfacePoint& point, std::int64_t& rays) const {
  return world_.lights.has_suns() &&
         reaches(point, world_.lights.sample_sun(point.normal, glm::vec2(0.5f)), rays);
}

std::uint8_t PathTracer::lit_by(const SurfacePoint& point, std::int64_t& rays) const {
  const glm::vec2 middle(0.5f);
  std::uint8_t lit = sees_sun(point, rays) ? 1 : 0;
  if (world_.lights.has_local() &&
      reaches(point, world_.lights.sample_local(point.origin, middle.x, middle), rays)) {
    lit |= 2;
  }
  return lit;
}

PathTracer::DirectParts PathTracer::direct_parts(const SurfacePoint& point, Sampler& sampler,
                                                 bool sends_ray, std::int64_t& rays) const {
  // Each part has its own numbers of a sample, whichever are wanted.
  Bounce bounce;
  const bool above = sample_ray(point, sampler, bounce);
  DirectParts parts;
  parts.sun = sample_sun(point, sampler, false, rays);
  parts.local = sample_local(point, sampler, false, rays);
  if (above && sends_ray) parts.met = emission_along(bounce, rays);
  return parts;
}

glm::vec3 PathTracer::sun_light(const SurfacePoint& point, Sampler& sampler,
                                std::int64_t& rays) const {
  (void)sampler.next_2d();  // of the ray
  return sample_sun(point, sampler, false, rays);
}

glm::vec3 PathTracer::direct(const SurfacePoint& point, Sampler& sampler,
                             std::int64_t& rays) const {
  const DirectParts parts = direct_parts(point, sampler, true, rays);
  return parts.sun + parts.local + parts.met;
}

glm::vec3 PathTracer::indirect(const SurfacePoint& point, const Sampler& sampler,
                               std::int64_t& rays) const {
  Path path(point, sampler);
  indirect(std::span<Path>(&path, 1), rays);
  return path.light;
}

void PathTracer::indirect(std::span<Path> paths, std::int64_t& rays) const {
  for (; !paths.empty(); paths = paths.subspan(std::min(paths.size(), kSideBySide))) {
    std::array<Path*, kSideBySide> alive{};
    const std::size_t size = std::min(paths.size(), kSideBySide);
    for (std::size_t i = 0; i < size; ++i) alive[i] = &paths[i];
    auto end = alive.begin() + static_cast<std::ptrdiff_t>(size);
    const auto keep = [&](const auto& goes_on) {
      end = std::remove_if(alive.begin(), end, [&](Path* path) { return !goes_on(*path); });
    };
    for (int depth = 0; end != alive.begin(); ++depth) {
      keep([&](Path& path) { return send(path, depth, rays); });
      std::for_each(alive.begin(), end, [&](Path* path) { resolve_hit(*path); });
      keep([&](Path& path) { return arrive(path, depth); });
      keep([&](Path& path) { return reflect(path, depth, rays); });
    }
  }
}

// One bounce of a path in four steps. Each step prefetches the memory that the next one reads and
// returns whether the path goes on.
bool PathTracer::send(Path& path, int depth, std::int64_t& rays) const {
  Bounce& bounce = path.bounce_;
  if (!sample_ray(path.at, path.sampler, bounce)) return false;
  bounce.ray.quick = true;
  if (depth == bounces_) {  // light that the last surface reflects
    path.light += path.throughput_ * emission_along(bounce, rays);
    return false;
  }
  trace(bounce, rays);
  return true;
}

void PathTracer::resolve_hit(Path& path) const {
  Bounce& bounce = path.bounce_;
  if (!bounce.hit) return;
  EmbreeScene::resolve_triangle(*bounce.hit);
  world_.surfaces.prefetch(*bounce.hit);
}

bool PathTracer::arrive(Path& path, int depth) const {
  const Bounce& bounce = path.bounce_;
  path.throughput_ *= bounce.tint;
  // The emission that the first ray meets is direct light.
  (depth > 0 ? path.light : path.met) += path.throughput_ * weighted_emission(bounce);
  if (!bounce.hit) return false;
  const auto [point, texel] = world_.surfaces.bounce_point(bounce.ray, *bounce.hit);
  path.at = point;
  path.texel_ = texel;
  if (texel != nullptr) __builtin_prefetch(texel);
  return true;
}

bool PathTracer::reflect(Path& path, int depth, std::int64_t& rays) const {
  if (path.texel_ != nullptr) path.at.albedo *= TexturePyramid::color(*path.texel_);
  glm::vec3& throughput = path.throughput_;
  throughput *= path.at.albedo;
  const glm::vec3 sun = sample_sun(path.at, path.sampler, true, rays);
  path.light += throughput * (sun + sample_local(path.at, path.sampler, true, rays));
  if (depth == 0) return true;
  // Russian roulette starts at the second bounce.
  const float brightest = std::max({throughput.x, throughput.y, throughput.z});
  const float survival = std::min(1.0f, brightest);
  if (!(path.sampler.next_1d() < survival)) return false;
  throughput /= survival;
  return true;
}

}  // namespace eigenlight
