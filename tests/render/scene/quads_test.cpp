#include "render/scene/quads.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <set>

#include "tests/support/scenes.h"

namespace eigenlight {
namespace {

std::vector<std::uint32_t> all(const Mesh& mesh) {
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0U);
  return triangles;
}

/// A wavy grid whose triangles start at random corners and come in random order.
Mesh shuffled_grid(int side, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> height(-0.3f, 0.3f);
  Mesh mesh;
  for (int y = 0; y <= side; ++y) {
    for (int x = 0; x <= side; ++x) mesh.positions.emplace_back(x, y, height(random));
  }
  const auto at = [side](int x, int y) { return static_cast<std::uint32_t>(y * (side + 1) + x); };
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      mesh.triangles.emplace_back(at(x, y), at(x + 1, y), at(x, y + 1));
      mesh.triangles.emplace_back(at(x + 1, y + 1), at(x, y + 1), at(x + 1, y));
    }
  }
  for (glm::uvec3& t : mesh.triangles) {
    for (auto turns = random() % 3; turns > 0; --turns) t = {t.y, t.z, t.x};
  }
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  return mesh;
}

glm::vec3 place(const Mesh& mesh, const Quads::Point& p) {
  const glm::uvec3& t = mesh.triangles[p.triangle];
  return (1.0f - p.u - p.v) * mesh.positions[t.x] + p.u * mesh.positions[t.y] +
         p.v * mesh.positions[t.z];
}

TEST(Quads, QuadPointsMatchTheirTriangles) {
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Mesh mesh = shuffled_grid(6, seed);
    const Quads quads(mesh, all(mesh));
    EXPECT_LT(quads.corners().size(), mesh.triangles.size());
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    std::set<std::uint32_t> met;
    for (std::uint32_t q = 0; q < quads.corners().size(); ++q) {
      const glm::uvec4& c = quads.corners()[q];
      const auto& at = mesh.positions;
      for (int i = 0; i < 40; ++i) {
        const float u = unit(random), v = unit(random);
        const bool beyond = u + v > 1.0f;
        if (beyond && c.z == c.w) continue;  // the quad holds a single triangle
        const glm::vec3 expected =
            beyond ? (u + v - 1.0f) * at[c.z] + (1.0f - u) * at[c.w] + (1.0f - v) * at[c.y]
                   : (1.0f - u - v) * at[c.x] + u * at[c.y] + v * at[c.w];
        const Quads::Point p = quads.point(q, u, v);
        met.insert(p.triangle);
        EXPECT_LT(glm::distance(place(mesh, p), expected), 1e-5f);
      }
    }
    EXPECT_EQ(met.size(), mesh.triangles.size()) << "a triangle is lost or stands twice";
  }
}

TEST(Quads, QuadsContainTheSelectedTrianglesOnly) {
  const Mesh mesh = shuffled_grid(4, 1);
  const std::vector<std::uint32_t> chosen{3, 7, 8, 20, 31};
  const Quads quads(mesh, chosen);
  std::multiset<std::uint32_t> met;
  for (std::uint32_t q = 0; q < quads.corners().size(); ++q) {
    met.insert(quads.point(q, 0.1f, 0.1f).triangle);
    const glm::uvec4& c = quads.corners()[q];
    if (c.z != c.w) met.insert(quads.point(q, 0.9f, 0.9f).triangle);
  }
  EXPECT_EQ(met, std::multiset<std::uint32_t>(chosen.begin(), chosen.end()));
}

TEST(Quads, TrianglesOfOppositeOrientationAreNotPaired) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}};
  EXPECT_EQ(Quads(mesh, all(mesh)).corners().size(), 2U);
  mesh.triangles[1] = {2, 1, 3};
  EXPECT_EQ(Quads(mesh, all(mesh)).corners().size(), 1U);
}

}  // namespace
}  // namespace eigenlight
