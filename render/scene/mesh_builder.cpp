#include "render/scene/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <tuple>
#include <utility>

namespace eigenlight {
namespace {

/// Texture coordinates in meters along the two world axes closest to the surface. On walls v grows
/// downward.
glm::vec2 axis_uv(const glm::vec3& position, const glm::vec3& normal) {
  const glm::vec3 a = abs(normal);
  if (a.y >= a.x && a.y >= a.z) return {position.x, position.z};
  return a.x >= a.z ? glm::vec2(position.z, -position.y) : glm::vec2(position.x, -position.y);
}

}  // namespace

unsigned MeshBuilder::vertex(const glm::vec3& position, const glm::vec3& normal,
                             const glm::vec2& uv) {
  mesh_.positions.push_back(position);
  mesh_.normals.push_back(normal);
  mesh_.texcoords.push_back(uv);
  return static_cast<unsigned>(mesh_.positions.size() - 1);
}

void MeshBuilder::quad(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                       const glm::vec3& d) {
  const glm::vec3 normal = normalize(cross(b - a, d - a));
  const unsigned first = vertex(a, normal, axis_uv(a, normal));
  for (const glm::vec3& p : {b, c, d}) vertex(p, normal, axis_uv(p, normal));
  add_triangle(first, first + 1, first + 2);
  add_triangle(first, first + 2, first + 3);
}

void MeshBuilder::picture(const glm::vec3& top_left, const glm::vec3& right,
                          const glm::vec3& down) {
  quad(top_left, top_left + down, top_left + down + right, top_left + right);
  const std::size_t first = mesh_.texcoords.size() - 4;
  mesh_.texcoords[first] = {0, 0};
  mesh_.texcoords[first + 1] = {0, 1};
  mesh_.texcoords[first + 2] = {1, 1};
  mesh_.texcoords[first + 3] = {1, 0};
}

void MeshBuilder::box(const glm::vec3& lower, const glm::vec3& upper) {
  const auto& [x0, y0, z0] = std::tie(lower.x, lower.y, lower.z);
  const auto& [x1, y1, z1] = std::tie(upper.x, upper.y, upper.z);
  quad({x0, y0, z1}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z1});
  quad({x1, y0, z0}, {x0, y0, z0}, {x0, y1, z0}, {x1, y1, z0});
  quad({x1, y0, z1}, {x1, y0, z0}, {x1, y1, z0}, {x1, y1, z1});
  quad({x0, y0, z0}, {x0, y0, z1}, {x0, y1, z1}, {x0, y1, z0});
  quad({x0, y1, z1}, {x1, y1, z1}, {x1, y1, z0}, {x0, y1, z0});
  quad({x0, y0, z0}, {x1, y0, z0}, {x1, y0, z1}, {x0, y0, z1});
}

void MeshBuilder::lathe(const Lathe& shape) {
  const std::size_t last = shape.profile.size() - 1;
  const auto edge_normal = [&](std::size_t i) {
    const glm::vec2 edge = shape.profile[i + 1] - shape.profile[i];
    return glm::normalize(glm::vec2(edge.y, -edge.x));
  };
  // Normal at an end of edge `i`: the mean with the `other` edge there, unless the bend is sharp.
  const auto end_normal = [&](std::size_t i, std::size_t other) {
    const glm::vec2 own = edge_normal(i), next = edge_normal(std::min(other, last - 1));
    return dot(own, next) > 0.766f ? glm::normalize(own + next) : own;  // cos 40 degrees
  };
  const auto ring = [&](const glm::vec2& point, const glm::vec2& normal, float v) {
    unsigned first = 0;
    for (int s = 0; s <= shape.segments; ++s) {
      const float turn = glm::two_pi<float>() * static_cast<float>(s % shape.segments) /
                         static_cast<float>(shape.segments);
      const glm::vec3 out(std::cos(turn), 0.0f, -std::sin(turn));
      const float u = static_cast<float>(s) / static_cast<float>(shape.segments);
      const unsigned index = vertex(shape.foot + out * point.x + glm::vec3(0, point.y, 0),
                                    out * normal.x + glm::vec3(0, normal.y, 0), {2.0f * u, v});
      if (s == 0) first = index;
    }
    return first;
  };
  float length = 0.0f;
  for (std::size_t i = 0; i < last; ++i) {
    const float next = length + distance(shape.profile[i], shape.profile[i + 1]);
    const unsigned low = ring(shape.profile[i], end_normal(i, i > 0 ? i - 1 : 0), -length);
    const unsigned high = ring(shape.profile[i + 1], end_normal(i, i + 1), -next);
    length = next;
    for (unsigned s = 0; s < static_cast<unsigned>(shape.segments); ++s) {
      // One of the two triangles has no area at the axis.
      if (shape.profile[i].x > 0) add_triangle(low + s, low + s + 1, high + s + 1);
      if (shape.profile[i + 1].x > 0) add_triangle(low + s, high + s + 1, high + s);
    }
  }
}

void MeshBuilder::arch(const Arch& shape) {
  const float z = shape.depth * 0.5f;
  const auto on_arc = [&](int i) {
    const float turn =
        glm::pi<float>() * static_cast<float>(i) / static_cast<float>(shape.segments);
    return glm::vec2(-shape.radius * std::cos(turn), shape.spring + shape.radius * std::sin(turn));
  };
  // Front, back and underside, in strips along the arc.
  for (int i = 0; i < shape.segments; ++i) {
    const glm::vec2 p = on_arc(i), q = on_arc(i + 1);
    quad({p, z}, {q, z}, {q.x, shape.top, z}, {p.x, shape.top, z});
    quad({q, -z}, {p, -z}, {p.x, shape.top, -z}, {q.x, shape.top, -z});
    quad({p, -z}, {q, -z}, {q, z}, {p, z});
  }
  // Boxes at both sides of the opening; they stand on the columns.
  for (const float side : {-1.0f, 1.0f}) {
    const float inner = side * shape.radius, outer = side * shape.half_width;
    const float left = std::min(inner, outer), right = std::max(inner, outer);
    box({left, shape.spring, -z}, {right, shape.top, z});
  }
}

void MeshBuilder::leaf(const glm::vec3& center, const glm::vec3& half_u, const glm::vec3& half_v) {
  quad(center - half_u - half_v, center + half_u - half_v, center + half_u + half_v,
       center - half_u + half_v);
}

void MeshBuilder::add_grid(int columns, int rows, std::span<const glm::vec3> points) {
  const auto at = [&](int i, int j) {
    const int x = std::clamp(i, 0, columns), y = std::clamp(j, 0, rows);
    return points[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns + 1) +
                  static_cast<std::size_t>(x)];
  };
  const auto first = static_cast<unsigned>(mesh_.positions.size());
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const glm::vec3 right = at(i + 1, j) - at(i - 1, j), down = at(i, j + 1) - at(i, j - 1);
      vertex(at(i, j), normalize(cross(down, right)),
             {static_cast<float>(i) / static_cast<float>(columns),
              static_cast<float>(j) / static_cast<float>(rows)});
    }
  }
  const auto width = static_cast<unsigned>(columns + 1);
  for (unsigned j = 0; j < static_cast<unsigned>(rows); ++j) {
    for (unsigned i = 0; i + 1 < width; ++i) {
      const unsigned a = first + j * width + i, b = a + width;
      add_triangle(a, b, b + 1);
      add_triangle(a, b + 1, a + 1);
    }
  }
}

Mesh MeshBuilder::take(const std::string& name, int material, float texture_scale) {
  for (glm::vec2& uv : mesh_.texcoords) uv *= texture_scale;
  mesh_.name = name;
  mesh_.material = material;
  return std::exchange(mesh_, {});
}

}  // namespace eigenlight
