#include "render/scene/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eigenlight {
namespace {

constexpr int kLeafTriangles = 8;

/// Squared distance from `p` to triangle (a, b, c) (Ericson, Real-Time Collision Detection, 5.1.5).
float squared_distance(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b,
                       const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  const auto to = [&](const glm::vec3& q) { return dot(p - q, p - q); };
  if (d1 <= 0 && d2 <= 0) return to(a);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + ab * (d1 / (d1 - d3)));
  if (d6 >= 0 && d5 <= d6) return to(c);
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + ac * (d2 / (d2 - d6)));
  const float va = d3 * d6 - d5 * d4;
  const float on_bc = d4 - d3, off_bc = d5 - d6;
  if (va <= 0 && on_bc >= 0 && off_bc >= 0) return to(b + (c - b) * (on_bc / (on_bc + off_bc)));
  const float sum = va + vb + vc;
  // A triangle without area can get here; its corners are then as near as its edges.
  if (!(sum > 0)) return std::min({to(a), to(b), to(c)});
  return to(a + ab * (vb / sum) + ac * (vc / sum));
}

float squared_distance(const glm::vec3& p, const glm::vec3& lower, const glm::vec3& upper) {
  const glm::vec3 d = max(max(lower - p, p - upper), glm::vec3(0.0f));
  return dot(d, d);
}

}  // namespace

Clearance::Clearance(const Scene& scene) : spheres_(scene.lights.spheres) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const auto corner = [&](unsigned i) {
      return glm::vec3(instance.to_world * glm::vec4(mesh.positions[i], 1.0f));
    };
    for (const glm::uvec3& t : mesh.triangles) add(corner(t.x), corner(t.y), corner(t.z));
  }
  for (const AreaRect& r : scene.lights.rects) {
    add(r.center - r.half_u - r.half_v, r.center + r.half_u - r.half_v,
        r.center + r.half_u + r.half_v);
    add(r.center - r.half_u - r.half_v, r.center + r.half_u + r.half_v,
        r.center - r.half_u + r.half_v);
  }
  nodes_.emplace_back();
  build(0, 0, static_cast<int>(triangles_.size()));
  lower_ = nodes_[0].lower;
  upper_ = nodes_[0].upper;
}

void Clearance::add(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  triangles_.push_back({a, b, c});
}

void Clearance::build(int node, int first, int count) {
  glm::vec3 lower(std::numeric_limits<float>::infinity()), upper(-lower);
  glm::vec3 center_lower(lower), center_upper(upper);
  for (int i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[static_cast<std::size_t>(i)];
    lower = min(lower, min(t.a, min(t.b, t.c)));
    upper = max(upper, max(t.a, max(t.b, t.c)));
    const glm::vec3 center = t.a + t.b + t.c;
    center_lower = min(center_lower, center);
    center_upper = max(center_upper, center);
  }
  nodes_[static_cast<std::size_t>(node)] = {lower, upper, first, count};
  if (count <= kLeafTriangles) return;

  // Split at the median along the longest axis, which balances the tree.
  const glm::vec3 size = center_upper - center_lower;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  const auto begin = triangles_.begin() + first;
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [axis](const Triangle& s, const Triangle& t) {
                     return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
                   });
  const int left = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[static_cast<std::size_t>(node)].first = left;
  nodes_[static_cast<std::size_t>(node)].count = 0;
  build(left, first, half);
  build(left + 1, first + half, count - half);
}

float Clearance::distance(const glm::vec3& point, float limit) const {
  float best = limit * limit;
  // Median splits limit the depth to log2 of the number of triangles, so 64 entries suffice.
  int stack[64] = {0};
  int top = triangles_.empty() ? 0 : 1;
  while (top > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(stack[--top])];
    if (!(squared_distance(point, node.lower, node.upper) < best)) continue;
    if (node.count > 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const Triangle& t = triangles_[static_cast<std::size_t>(i)];
        best = std::min(best, squared_distance(point, t.a, t.b, t.c));
      }
      continue;
    }
    const Node& left = nodes_[static_cast<std::size_t>(node.first)];
    const Node& right = nodes_[static_cast<std::size_t>(node.first + 1)];
    const bool left_nearer = squared_distance(point, left.lower, left.upper) <
                             squared_distance(point, right.lower, right.upper);
    stack[top++] = node.first + (left_nearer ? 1 : 0);
    stack[top++] = node.first + (left_nearer ? 0 : 1);
  }
  float result = std::min(limit, std::sqrt(best));
  for (const SphereLight& s : spheres_) {
    result = std::min(result, glm::distance(point, s.center) - s.radius);
  }
  return result;
}

float Clearance::free_travel(const Cone& cone, float limit) const {
  float travel = 0.0f;
  while (travel < limit) {
    // The cone at `travel` + s has radius slope * (travel + s) and must fit into the free ball.
    const float reach = (limit - travel) * (1.0f + cone.slope) + cone.slope * travel;
    const float free = distance(cone.origin + cone.direction * travel, reach);
    const float step = (free - cone.slope * travel) / (1.0f + cone.slope);
    // Steps below a thousandth of the travel count as contact, because they only get smaller.
    if (step <= 1e-3f * travel || step <= 0.0f) return travel;
    travel += step;
  }
  return limit;
}

}  // namespace eigenlight
