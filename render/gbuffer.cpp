#include "render/gbuffer.h"

#include <cmath>
#include <limits>
#include <optional>

#include "render/light_shapes.h"

namespace eigenlight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Everything that one pixel gets.
struct Pixel {
  float depth = kInfinity;
  glm::vec3 normal{0.0f}, albedo{0.0f}, position{0.0f}, emission{0.0f};
  std::uint32_t id = 0;
  glm::vec3 before{0.0f};  // in the previous camera's view space; the direction, for the sky
};

void store(const glm::vec3& value, int x, int y, Planes<3>& planes) {
  for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)](x, y) = value[c];
}

void store(const Pixel& pixel, const Camera& previous, glm::ivec2 at, Frame& frame) {
  const auto [x, y] = std::pair(at.x, at.y);
  frame.surface.depth(x, y) = pixel.depth;
  frame.surface.id(x, y) = pixel.id;
  store(pixel.normal, x, y, frame.surface.normal);
  store(pixel.albedo, x, y, frame.surface.albedo);
  store(pixel.position, x, y, frame.position);
  store(pixel.emission, x, y, frame.emission);
  const bool seen = pixel.before.z > 0.0f;
  const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const glm::vec2 motion =
      seen ? previous.view_to_pixel(pixel.before) - center : glm::vec2(kUnseenMotion);
  // A grazing point may land anywhere; beyond the bound it is just as far outside.
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

// Shapes are told apart by their place in Lights; if that list has changed, they stand still.
void fill_shape(const World& world, const PreviousView& previous, const ShapeHit& hit,
                Pixel& pixel) {
  const Lights& now = world.lights.lights();
  const Lights& then = previous.lights;
  glm::vec3 before = pixel.position;
  if (hit.shape < now.rects.size()) {
    const AreaRect& rect = now.rects[hit.shape];
    pixel.normal = shape_normal(rect, pixel.position);
    if (then.rects.size() == now.rects.size()) {
      before = previous_point(rect, then.rects[hit.shape], pixel.position);
    }
  } else {
    const std::size_t index = hit.shape - now.rects.size();
    const SphereLight& sphere = now.spheres[index];
    pixel.normal = shape_normal(sphere, pixel.position);
    if (then.spheres.size() == now.spheres.size()) {
      before = previous_point(sphere, then.spheres[index], pixel.position);
    }
  }
  pixel.emission = hit.radiance;
  pixel.id = static_cast<std::uint32_t>(world.geometry.transforms().size()) + 1U + hit.shape;
  pixel.before = previous.camera.to_view(before);
}

void fill_surface(const World& world, const PreviousView& previous, const Ray& ray, const Hit& hit,
                  Pixel& pixel, const SurfacePoint& point) {
  pixel.normal = point.normal;
  pixel.albedo = glm::clamp(point.albedo, 0.0f, 1.0f);
  pixel.position = point.position;
  pixel.emission = world.lights.emitted(world.surfaces.emission(hit), ray.direction);
  pixel.id = hit.instance + 1U;
  pixel.before =
      previous.camera.to_view(world.surfaces.position(hit, previous.poses[hit.instance]));
}

}  // namespace

std::int64_t trace_guides(const World& world, const PreviousView& previous, const Tile& tile,
                          Frame& frame, Plane<GuideHit>& hits) {
  const Camera& camera = frame.camera;
  const glm::mat3 view_to_world = glm::transpose(camera.world_to_view);
  const float spread = 1.0f / camera.focal;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const glm::vec2 center(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      Ray ray{camera.eye, glm::normalize(view_to_world * camera.pixel_to_view(center))};
      Pixel pixel;
      GuideHit& guide = hits(x, y);
      guide = {};
      const std::optional<Hit> hit = world.geometry.intersect(ray);
      if (hit) ray.t_max = hit->t;
      if (const std::optional<ShapeHit> shape = world.lights.intersect(ray)) {
        guide.kind = GuideHit::Kind::kShape;
        pixel.position = ray.origin + shape->t * ray.direction;
        fill_shape(world, previous, *shape, pixel);
      } else if (hit) {
        guide = {GuideHit::Kind::kSurface, world.surfaces.guide_point(ray, *hit, spread)};
        fill_surface(world, previous, ray, *hit, pixel, guide.point);
      } else {
        pixel.emission = world.lights.escaped(ray.direction);
        pixel.before = previous.camera.world_to_view * ray.direction;
      }
      if (pixel.id != 0) pixel.depth = camera.to_view(pixel.position).z;
      store(pixel, previous.camera, {x, y}, frame);
    }
  }
  return tile.pixels();
}

}  // namespace eigenlight
