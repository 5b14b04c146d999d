#include "sequences/conventions/camera_solve.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/sequences/conventions/analytic_shot.h"

namespace eigenlight {
namespace {

using Matrix = std::array<float, 16>;

// How far apart both cameras see points of the picture at some depths; pixels.
double disagreement(const Camera& a, const Camera& b, Extent extent) {
  double worst = 0.0;
  for (const float depth : {1.0f, 4.0f, 20.0f}) {
    for (const float x : {0.0f, 1.0f}) {
      for (const float y : {0.0f, 1.0f}) {
        const glm::vec2 pixel(x * static_cast<float>(extent.width),
                              y * static_cast<float>(extent.height));
        const glm::vec3 world = a.to_world(a.pixel_to_view(pixel) * depth);
        const glm::vec2 seen = b.view_to_pixel(b.to_view(world));
        worst = std::max(worst, static_cast<double>(glm::length(seen - pixel)));
      }
    }
  }
  return worst;
}

TEST(SolveCamera, FindsTheCameraOfExactPositions) {
  const AnalyticShot shot;
  const RawGuides frame = shot.frame(2);
  const auto fit = solve_camera(frame.position, frame.depth);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->residual, 1e-3);
  EXPECT_EQ(fit->outliers, 0.0);
  EXPECT_FALSE(fit->in_view_space);
  EXPECT_LT(disagreement(*frame.camera, fit->camera, shot.extent), 0.01);
}

TEST(SolveCamera, StandsHalfsRoundingSkyAndOutliers) {
  AnalyticShot shot;
  shot.has_back_wall = false;
  RawGuides frame = shot.frame(2);
  for (Plane<float>& plane : frame.position) round_to_half(plane);
  for (int x = 0; x < shot.extent.width; x += 3) {  // mixed pixels
    for (Plane<float>& plane : frame.position) {
      for (int y = 60; y < 70; ++y) plane(x, y) *= 0.5f;
    }
  }
  const auto fit = solve_camera(frame.position, frame.depth);
  ASSERT_TRUE(fit);
  EXPECT_LT(fit->residual, 0.2);
  EXPECT_GT(fit->outliers, 0.0);
  EXPECT_LT(disagreement(*frame.camera, fit->camera, shot.extent), 0.5);
}

TEST(SolveCamera, FindsAShiftedLens) {
  const AnalyticShot shot;
  RawGuides frame = shot.frame(1);
  Camera camera = *frame.camera;
  camera.center += glm::vec2(12.0f, -7.0f);
  // What the shifted camera sees at a pixel, another pixel of the plain one sees.
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {
      const AnalyticShot::Hit hit = shot.hit(1, x - 12, y + 7);
      frame.depth(x, y) = hit.depth;
      for (int c = 0; c < 3; ++c) frame.position[c](x, y) = hit.position[c];
    }
  }
  const auto fit = solve_camera(frame.position, frame.depth);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->camera.center.x, camera.center.x, 0.05);
  EXPECT_NEAR(fit->camera.center.y, camera.center.y, 0.05);
}

TEST(SolveCamera, KnowsPositionsInViewSpace) {
  const AnalyticShot shot;
  RawGuides frame = shot.frame(2);
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {
      const AnalyticShot::Hit hit = shot.hit(2, x, y);
      const glm::vec3 view = frame.camera->to_view(hit.position);
      // pbrt: x right, y up, z forward.
      frame.position[0](x, y) = view.x;
      frame.position[1](x, y) = -view.y;
      frame.position[2](x, y) = view.z;
    }
  }
  const auto fit = solve_camera(frame.position, frame.depth);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->in_view_space);
  EXPECT_NEAR(fit->camera.focal, frame.camera->focal, 0.01f * frame.camera->focal);
}

TEST(SolveCamera, RefusesOnePlaneAndTooFewPoints) {
  AnalyticShot shot;
  RawGuides frame = shot.frame(0);
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {
      const AnalyticShot::Hit hit = shot.hit(0, x, y);
      if (hit.normal.y < 0.999f) frame.depth(x, y) = 1e10f;  // the floor stays
    }
  }
  EXPECT_FALSE(solve_camera(frame.position, frame.depth));
  frame.depth.fill(1e10f);
  EXPECT_FALSE(solve_camera(frame.position, frame.depth));
}

TEST(SolveCamera, RefusesWhatNoPinholeSees) {
  const AnalyticShot shot;
  RawGuides frame = shot.frame(0);
  for (int y = 0; y < shot.extent.height; ++y) {
    for (int x = 0; x < shot.extent.width; ++x) {  // noise in place of positions
      for (int c = 0; c < 3; ++c) {
        frame.position[c](x, y) = static_cast<float>((x * 7919 + y * 104729 + c * 31337) % 1000);
      }
    }
  }
  EXPECT_FALSE(solve_camera(frame.position, frame.depth));
}

// OpenEXR's worldToCamera: x right, y up, z forward.
Matrix world_to_camera(const Camera& camera) {
  const glm::vec3 offset = camera.to_view(glm::vec3(0.0f));
  const float sign[3] = {1.0f, -1.0f, 1.0f};
  Matrix m{};
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      m[static_cast<std::size_t>(4 * r + c)] = sign[c] * camera.world_to_view[r][c];
    }
    m[static_cast<std::size_t>(12 + c)] = sign[c] * offset[c];
  }
  m[15] = 1.0f;
  return m;
}

// worldToNDC from what NDC is of a view-space direction (x right, y down, z = 1).
Matrix world_to_ndc(const Camera& camera, const glm::vec2& scale, const glm::vec2& offset) {
  const glm::vec3 origin = camera.to_view(glm::vec3(0.0f));
  Matrix m{};
  for (std::size_t r = 0; r < 4; ++r) {
    const glm::vec3 view = r < 3 ? camera.world_to_view[static_cast<int>(r)] : origin;
    m[4 * r] = scale.x * view.x + offset.x * view.z;
    m[4 * r + 1] = scale.y * view.y + offset.y * view.z;
    m[4 * r + 3] = view.z;
  }
  return m;
}

TEST(CameraFromMatrices, ReadsEveryPictureOfNdc) {
  const AnalyticShot shot;
  const Camera camera = shot.camera(3);
  const float w = 160, h = 90, f = camera.focal;
  struct Case {
    const char* name;
    glm::vec2 scale, offset;
  };
  for (const Case& c : {Case{"OpenEXR", {f / w, f / h}, {0.5f, 0.5f}},
                        Case{"-1 to 1, y up", {2 * f / w, -2 * f / h}, {0, 0}},
                        Case{"over the width", {2 * f / w, -2 * f / w}, {0, 0}},
                        Case{"pbrt", {f / h, -f / h}, {0.5f, 0.5f}}}) {
    const auto read = camera_from_matrices(world_to_camera(camera),
                                           world_to_ndc(camera, c.scale, c.offset), shot.extent);
    ASSERT_TRUE(read) << c.name;
    EXPECT_LT(disagreement(camera, *read, shot.extent), 0.01) << c.name;
  }
}

TEST(CameraFromMatrices, ReadsArnoldsFile) {
  // From the header of an Arnold 5.1 file of 128 x 128 pixels with a field of view of 45 degrees.
  const Matrix camera{0.707107f,    -0.339275f, -0.620397f, 0,          0,          0.877374f,
                      -0.479807f,   0,          -0.707107f, -0.339275f, -0.620397f, 0,
                      2.68221e-07f, 0.164701f,  3.07752f,   1};
  const Matrix ndc{1.7071f,      -0.819081f, -0.620413f, -0.620397f, 0,          2.11817f,
                   -0.47982f,    -0.479807f, -1.70711f,  -0.819081f, -0.620413f, -0.620397f,
                   6.47542e-07f, 0.397622f,  2.97759f,   3.07752f};
  const auto read = camera_from_matrices(camera, ndc, {128, 128});
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->focal, 64.0 / std::tan(22.5 * M_PI / 180.0), 0.01);
  EXPECT_NEAR(read->center.x, 64.0f, 0.01f);
  EXPECT_NEAR(read->center.y, 64.0f, 0.01f);
  EXPECT_GT(glm::determinant(read->world_to_view), 0.99f);  // a right-handed world
  const glm::vec3 above = read->to_view(read->eye + glm::vec3(0, 1, 0));
  EXPECT_LT(above.y, 0.0f);  // up is up
}

TEST(CameraFromMatrices, RefusesWhatIsNoCamera) {
  const AnalyticShot shot;
  const Camera camera = shot.camera(3), other = shot.camera(9);
  const Matrix ndc = world_to_ndc(camera, {camera.focal / 160, camera.focal / 90}, {0.5f, 0.5f});
  EXPECT_TRUE(camera_from_matrices(world_to_camera(camera), ndc, shot.extent));
  EXPECT_FALSE(camera_from_matrices(world_to_camera(other), ndc, shot.extent));
  EXPECT_FALSE(camera_from_matrices(world_to_camera(camera), Matrix{}, shot.extent));
  EXPECT_FALSE(camera_from_matrices(Matrix{}, ndc, shot.extent));
  const Matrix stretched = world_to_ndc(camera, {0.37f, 0.9f}, {0.5f, 0.5f});
  EXPECT_FALSE(camera_from_matrices(world_to_camera(camera), stretched, shot.extent));
}

TEST(CameraFromVray, ReadsAnUnturnedMayaCamera) {
  // From the header of a file of V-Ray for Maya: a camera at (0, 5, 20) that looks along -z, y up.
  const Matrix matrix{1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 5, 20, 1};
  const auto camera = camera_from_vray(matrix, 54.4322f, {960, 540});
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->eye, glm::vec3(0, 5, 20));
  EXPECT_NEAR(camera->focal, 480.0 / std::tan(27.2161 * M_PI / 180.0), 0.1);
  EXPECT_EQ(camera->center, glm::vec2(480, 270));
  EXPECT_EQ(camera->to_view({0, 5, 10}), glm::vec3(0, 0, 10));
  EXPECT_EQ(camera->to_view({1, 7, 10}), glm::vec3(1, -2, 10));
}

TEST(CameraFromVray, RefusesWhatIsNoCamera) {
  Matrix matrix{1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 5, 20, 1};
  EXPECT_FALSE(camera_from_vray(matrix, 180.0f, {960, 540}));
  EXPECT_FALSE(camera_from_vray(matrix, 0.0f, {960, 540}));
  EXPECT_FALSE(camera_from_vray(Matrix{}, 50.0f, {960, 540}));
  matrix[1] = 1.0f;
  matrix[5] = 1.0f;
  EXPECT_FALSE(camera_from_vray(matrix, 50.0f, {960, 540}));
}

}  // namespace
}  // namespace eigenlight
