#include "render/rays/surface.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {
namespace {

// A ray starts off the surface by this fraction of (largest coordinate + distance traveled). That
// is about 100 float ulps, or twenty times the error of origin + t * direction.
constexpr float kOffset = 1e-5f;

// New rays start a little back on the ray that found the surface, where space is known to be empty.
// An offset along the normal alone could put a point in a corner inside the next wall. On a grazing
// ray the start moves back by at most 1 / kLeastCosine offsets; the rest of the height is along the
// normal.
constexpr float kLeastCosine = 0.1f;

glm::vec2 interpolate(const std::array<glm::vec2, 3>& uv, const Hit& hit) {
  return (1.0f - hit.u - hit.v) * uv[0] + hit.u * uv[1] + hit.v * uv[2];
}

std::array<std::int16_t, 3> pack(const glm::vec3& normal) {
  const float length = glm::length(normal);
  if (!(length > 0.0f)) return {0, 0, 0};  // zero or NaN: shading_normal() uses the flat normal
  const glm::vec3 n = normal / length * 32767.0f;
  return {static_cast<std::int16_t>(std::lround(n.x)), static_cast<std::int16_t>(std::lround(n.y)),
          static_cast<std::int16_t>(std::lround(n.z))};
}

glm::vec3 unpack(const std::array<std::int16_t, 3>& n) {
  return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

}  // namespace

SurfaceTable::Triangle SurfaceTable::make_triangle(const Appearance& appearance,
                                                   const glm::uvec3& corners) {
  Triangle triangle{};
  for (int k = 0; k < 3; ++k) {
    const auto slot = static_cast<std::size_t>(k);
    if (appearance.smooth) triangle.normals[slot] = pack(appearance.mesh->normals[corners[k]]);
    if (appearance.texture != nullptr) triangle.uv[slot] = appearance.mesh->texcoords[corners[k]];
  }
  if (appearance.texture == nullptr) return triangle;
  const auto& p = appearance.mesh->positions;
  const float area =
      glm::length(glm::cross(p[corners.y] - p[corners.x], p[corners.z] - p[corners.x]));
  const glm::vec2 a = triangle.uv[1] - triangle.uv[0];
  const glm::vec2 b = triangle.uv[2] - triangle.uv[0];
  const auto pixels = static_cast<float>(appearance.texture->extent().pixels());
  triangle.texels = area > 0.0f ? std::abs(a.x * b.y - a.y * b.x) * pixels / area : 0.0f;
  return triangle;
}

SurfaceTable::SurfaceTable(const Scene& scene, const EmbreeScene& geometry) : geometry_(&geometry) {
  textures_.reserve(scene.textures.size());
  for (const Texture& texture : scene.textures) textures_.emplace_back(texture);
  appearances_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    Appearance& appearance = appearances_.emplace_back();
    appearance.mesh = &mesh;
    appearance.base_color = material.base_color;
    appearance.emission = material.emission;
    appearance.smooth = !mesh.normals.empty();
    if (material.texture >= 0 && !mesh.texcoords.empty()) {
      appearance.texture = &textures_[static_cast<std::size_t>(material.texture)];
    }
    if (!appearance.smooth && appearance.texture == nullptr) continue;
    appearance.triangles.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles)
      appearance.triangles.push_back(make_triangle(appearance, t));
  }
  for (const Instance& instance : scene.instances) {
    appearance_of_.push_back(&appearances_[static_cast<std::size_t>(instance.mesh)]);
  }
}

glm::vec3 SurfaceTable::position(const Hit& hit, const glm::mat4& to_world) const {
  const Mesh& mesh = *appearance_of_[hit.instance]->mesh;
  const glm::uvec3 t = mesh.triangles[hit.triangle];
  const glm::vec3 local = (1.0f - hit.u - hit.v) * mesh.positions[t.x] +
                          hit.u * mesh.positions[t.y] + hit.v * mesh.positions[t.z];
  return glm::vec3(to_world * glm::vec4(local, 1.0f));
}

glm::vec3 SurfaceTable::shading_normal(const Hit& hit, const glm::vec3& geometric,
                                       const glm::vec3& view) const {
  const Appearance& appearance = *appearance_of_[hit.instance];
  if (!appearance.smooth) return geometric;
  const auto& corners = appearance.triangles[hit.triangle].normals;
  const glm::vec3 local = (1.0f - hit.u - hit.v) * unpack(corners[0]) + hit.u * unpack(corners[1]) +
                          hit.v * unpack(corners[2]);
  const glm::vec3 world = geometry_->normal_matrix(hit.instance) * local;
  const float length = glm::length(world);
  if (!(length > 0.0f)) return geometric;
  glm::vec3 normal = world / length;
  if (glm::dot(normal, geometric) < 0.0f) normal = -normal;
  return glm::dot(normal, view) < 0.0f ? normal : geometric;
}

SurfacePoint SurfaceTable::point(const Ray& ray, const Hit& hit, const glm::vec3& position) const {
  const glm::vec3 geometric = glm::dot(hit.normal, ray.direction) > 0.0f ? -hit.normal : hit.normal;
  const float reach =
      std::max({std::abs(position.x), std::abs(position.y), std::abs(position.z)}) + hit.t;
  const float height = kOffset * reach;
  const float cosine = -glm::dot(geometric, ray.direction);
  const float back = std::min(height / std::max(cosine, kLeastCosine), hit.t);
  const glm::vec3 origin = position - back * ray.direction + (height - back * cosine) * geometric;
  return {position, geometric, shading_normal(hit, geometric, ray.direction),
          appearance_of_[hit.instance]->base_color, origin};
}

float SurfaceTable::footprint(const Ray& ray, const Hit& hit, float spread) const {
  const float cosine = std::max(std::abs(glm::dot(hit.normal, ray.direction)), 1e-3f);
  const float width = spread * hit.t / cosine;
  const float texels = appearance_of_[hit.instance]->triangles[hit.triangle].texels;
  return texels * width * width / geometry_->area_scale(hit.instance);
}

SurfacePoint SurfaceTable::guide_point(const Ray& ray, const Hit& hit, float spread) const {
  const glm::mat4& to_world = geometry_->transforms()[hit.instance];
  SurfacePoint p = point(ray, hit, position(hit, to_world));
  const Appearance& appearance = *appearance_of_[hit.instance];
  if (appearance.texture == nullptr) return p;
  const float level = 0.5f * std::log2(std::max(footprint(ray, hit, spread), 1.0f));
  p.albedo *=
      appearance.texture->trilinear(interpolate(appearance.triangles[hit.triangle].uv, hit), level);
  return p;
}

SurfaceTable::BouncePoint SurfaceTable::bounce_point(const Ray& ray, const Hit& hit) const {
  BouncePoint p{point(ray, hit, ray.origin + hit.t * ray.direction)};
  const Appearance& appearance = *appearance_of_[hit.instance];
  if (appearance.texture == nullptr) return p;
  const int level = std::ilogb(std::max(footprint(ray, hit, kBounceSpread), 1.0f)) / 2;
  p.texel = &appearance.texture->nearest_texel(
      interpolate(appearance.triangles[hit.triangle].uv, hit), level);
  return p;
}

}  // namespace eigenlight
