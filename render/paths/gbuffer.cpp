#include "render/paths/gbuffer.h"

#include <cmath>
#include <limits>
#include <optional>

#include "render/lights/light_shapes.h"
#include "render/paths/sample_mean.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// All values of one pixel of the G-buffer.
struct Pixel {
  EyeHit eye;
  std::uint32_t id = 0;
  glm::vec3 before{0.0f};  // position in the previous view space; for the sky its direction
};

void store(const Pixel& pixel, const Camera& previous, glm::ivec2 at, Frame& frame) {
  const auto [x, y] = std::pair(at.x, at.y);
  const EyeHit& eye = pixel.eye;
  frame.surface.depth(x, y) = eye.depth;
  frame.surface.id(x, y) = pixel.id;
  store_pixel(eye.normal, x, y, frame.surface.normal);
  store_pixel(eye.albedo, x, y, frame.surface.albedo);
  store_pixel(eye.position, x, y, frame.position);
  store_pixel(eye.emission, x, y, frame.emission);
  const bool seen = pixel.before.z > 0.0f;
  const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const glm::vec2 motion =
      seen ? previous.view_to_pixel(pixel.before) - center : glm::vec2(kUnseenMotion);
  // Points near the plane of the previous camera project to huge values: clamp them to the bound.
  frame.motion[0](x, y) = glm::clamp(motion.x, kUnseenMotion, -kUnseenMotion);
  frame.motion[1](x, y) = glm::clamp(motion.y, kUnseenMotion, -kUnseenMotion);
  frame.previous_depth(x, y) = seen && pixel.id == 0 ? kInfinity : pixel.before.z;
}

glm::vec3 previous_point(const AreaRect& now, const AreaRect& before, const glm::vec3& point) {
  const glm::vec3 normal = glm::cross(now.half_u, now.half_v);
  const float area2 = glm::dot(normal, normal);
  const glm::vec3 p = point - now.center;
  const float a = glm::dot(glm::cross(p, now.half_v), normal) / area2;
  const float b = glm::dot(glm::cross(now.half_u, p), normal) / area2;
  return before.center + a * before.half_u + b * before.half_v;
}

glm::vec3 previous_point(const SphereLight& now, const SphereLight& before,
                         const glm::vec3& point) {
  return before.center + (point - now.center) * (before.radius / now.radius);
}

glm::vec3 shape_normal_at(const Lights& lights, std::uint32_t shape, const glm::vec3& point) {
  if (shape < lights.rects.size()) return shape_normal(lights.rects[shape], point);
  return shape_normal(lights.spheres[shape - lights.rects.size()], point);
}

// Light shapes are identified by their index in Lights. If the number of shapes has changed, they
// count as not moving.
glm::vec3 previous_point(const Lights& now, const Lights& then, const EyeHit& eye) {
  const std::uint32_t shape = eye.shape.shape;
  if (shape < now.rects.size()) {
    if (then.rects.size() != now.rects.size()) return eye.position;
    return previous_point(now.rects[shape], then.rects[shape], eye.position);
  }
  if (then.spheres.size() != now.spheres.size()) return eye.position;
  const std::size_t index = shape - now.rects.size();
  return previous_point(now.spheres[index], then.spheres[index], eye.position);
}

// Finds the id of the hit and its position in the previous frame.
Pixel identify(const World& world, const PreviousView& previous, const EyeHit& eye) {
  Pixel pixel{eye};
  const Camera& camera = previous.camera;
  switch (eye.guide.kind) {
    case GuideHit::Kind::kSky:
      pixel.before = camera.world_to_view * eye.direction;
      break;
    case GuideHit::Kind::kShape:
      pixel.id =
          static_cast<std::uint32_t>(world.geometry.transforms().size()) + 1U + eye.shape.shape;
      pixel.before = camera.to_view(previous_point(world.lights.lights(), previous.lights, eye));
      break;
    case GuideHit::Kind::kSurface:
      pixel.id = eye.hit.instance + 1U;
      pixel.before =
          camera.to_view(world.surfaces.position(eye.hit, previous.poses[eye.hit.instance]));
      break;
  }
  return pixel;
}

}  // namespace

EyeHit trace_eye(const World& world, const Camera& camera, const glm::vec2& pixel, float spread) {
  const glm::mat3 view_to_world = glm::transpose(camera.world_to_view);
  Ray ray{camera.eye, glm::normalize(view_to_world * camera.pixel_to_view(pixel))};
  EyeHit eye;
  eye.direction = ray.direction;
  const std::optional<Hit> hit = world.geometry.intersect(ray);
  if (hit) ray.t_max = hit->t;
  if (const std::optional<ShapeHit> shape = world.lights.intersect(ray)) {
    eye.guide.kind = GuideHit::Kind::kShape;
    eye.shape = *shape;
    eye.position = ray.origin + shape->t * ray.direction;
    eye.normal = shape_normal_at(world.lights.lights(), shape->shape, eye.position);
    eye.emission = shape->radiance;
  } else if (hit) {
    eye.guide = {GuideHit::Kind::kSurface, world.surfaces.guide_point(ray, *hit, spread)};
    eye.hit = *hit;
    eye.position = eye.guide.point.position;
    eye.normal = eye.guide.point.normal;
    eye.albedo = glm::clamp(eye.guide.point.albedo, 0.0f, 1.0f);
    eye.emission = world.lights.emitted(world.surfaces.emission(*hit), ray.direction);
  } else {
    eye.emission = world.lights.background(ray.direction);
    return eye;
  }
  eye.depth = camera.to_view(eye.position).z;
  return eye;
}

std::int64_t trace_guides(const World& world, const PreviousView& previous, const Rect& tile,
                          Frame& frame, Plane<GuideHit>& hits) {
  const float spread = 1.0f / frame.camera.focal;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const EyeHit eye = trace_eye(world, frame.camera, center, spread);
      hits(x, y) = eye.guide;
      store(identify(world, previous, eye), previous.camera, {x, y}, frame);
    }
  }
  return tile.pixels();
}

}  // namespace eigenlight
