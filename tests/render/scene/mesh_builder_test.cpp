#include "render/scene/mesh_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace eigenlight {
namespace {

/// Volume by the divergence theorem. It is positive and exact only if the mesh is closed and faces
/// outward.
double signed_volume(const Mesh& mesh) {
  double volume = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    volume += static_cast<double>(
        dot(mesh.positions[t.x], cross(mesh.positions[t.y], mesh.positions[t.z])));
  }
  return volume / 6.0;
}

void expect_normals_agree(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.texcoords.size(), mesh.positions.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3& a = mesh.positions[t.x];
    const glm::vec3 face = cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    ASSERT_GT(length(face), 0.0f);
    for (int k = 0; k < 3; ++k) {
      ASSERT_NEAR(length(mesh.normals[t[k]]), 1.0f, 1e-4f);
      ASSERT_GT(dot(mesh.normals[t[k]], face), 0.0f);
    }
  }
}

TEST(MeshBuilder, BoxIsClosedAndFacesOutward) {
  MeshBuilder builder;
  builder.box({1, 2, 3}, {2, 4, 6});
  const Mesh box = builder.take("box", 4);
  EXPECT_NEAR(signed_volume(box), 6.0, 1e-4);
  EXPECT_EQ(box.material, 4);
  expect_normals_agree(box);
}

TEST(MeshBuilder, LatheOfASemicircleIsASphere) {
  MeshBuilder builder;
  MeshBuilder::Lathe shape{.profile = {}, .segments = 96, .foot = {5, 0, -2}};
  for (int i = 0; i <= 64; ++i) {
    const float turn = glm::pi<float>() * static_cast<float>(i) / 64.0f;
    const bool pole = i == 0 || i == 64;
    shape.profile.emplace_back(pole ? 0.0f : std::sin(turn), -std::cos(turn));
  }
  builder.lathe(shape);
  const Mesh ball = builder.take("ball", 0);
  expect_normals_agree(ball);
  EXPECT_NEAR(signed_volume(ball), 4.0 / 3.0 * glm::pi<double>(), 0.01);
  for (std::size_t i = 0; i < ball.positions.size(); ++i) {
    ASSERT_GT(dot(ball.normals[i], ball.positions[i] - shape.foot), 0.99f);
  }
}

TEST(MeshBuilder, LatheKeepsSharpEdges) {
  MeshBuilder builder;
  builder.lathe({.profile = {{1, 0}, {1, 1}, {0, 1}}, .segments = 16, .foot = glm::vec3(0.0f)});
  const Mesh can = builder.take("can", 0);
  for (const glm::vec3& n : can.normals) {
    EXPECT_TRUE(std::abs(n.y) < 1e-6f || n.y > 1.0f - 1e-6f) << n.y;
  }
}

// The volume is 2 half_width * (top - spring) * depth minus half a disc of the arch.
TEST(MeshBuilder, ArchHasTheVolumeOfAWallMinusItsOpening) {
  MeshBuilder builder;
  const MeshBuilder::Arch shape{
      .half_width = 2, .radius = 1, .spring = 3, .top = 5, .depth = 0.5f, .segments = 96};
  builder.arch(shape);
  const Mesh arch = builder.take("arch", 0);
  // The part above the opening has no top and no ends, because a floor and the sides cover them.
  // Their parts of the integral are height * area / 3 and radius * area / 3.
  const double top = 5.0 * (2.0 * 0.5) / 3.0, ends = 2.0 * 1.0 * (2.0 * 0.5) / 3.0;
  EXPECT_NEAR(signed_volume(arch) + top + ends, 4.0 * 2.0 * 0.5 - 0.25 * glm::pi<double>(), 1e-3);
  expect_normals_agree(arch);
}

TEST(MeshBuilder, PictureTextureIsUpright) {
  MeshBuilder builder;
  builder.picture({-1, 1, 0}, {2, 0, 0}, {0, -2, 0});
  const Mesh canvas = builder.take("canvas", 0);
  for (std::size_t i = 0; i < canvas.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(canvas.texcoords[i].x, 0.5f * (canvas.positions[i].x + 1.0f));
    EXPECT_FLOAT_EQ(canvas.texcoords[i].y, 0.5f * (1.0f - canvas.positions[i].y));
    EXPECT_FLOAT_EQ(canvas.normals[i].z, 1.0f);
  }
}

TEST(MeshBuilder, SheetFollowsItsFunction) {
  MeshBuilder builder;
  builder.sheet(8, 4, [](float u, float v) { return glm::vec3(u, -v, 0.5f * u); });
  const Mesh sheet = builder.take("sheet", 0, 2.0f);
  EXPECT_EQ(sheet.triangles.size(), 64U);
  expect_normals_agree(sheet);
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(sheet.texcoords[i].x, 2.0f * sheet.positions[i].x);
    EXPECT_NEAR(dot(sheet.normals[i], glm::normalize(glm::vec3(-0.5f, 0, 1))), 1.0f, 1e-5f);
  }
}

}  // namespace
}  // namespace eigenlight
