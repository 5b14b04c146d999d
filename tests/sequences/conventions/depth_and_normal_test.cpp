#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "sequences/conventions/background.h"
#include "sequences/conventions/depth_reading.h"
#include "sequences/conventions/normal_reading.h"
#include "tests/sequences/conventions/analytic_shot.h"

namespace eigenlight {
namespace {

using ::testing::HasSubstr;

// Distance along the ray in place of that along the axis.
void make_ray_depth(RawGuides& guides) {
  for (int y = 0; y < guides.depth.height(); ++y) {
    for (int x = 0; x < guides.depth.width(); ++x) {
      if (is_background(guides.depth(x, y))) continue;
      const glm::vec2 pixel(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      guides.depth(x, y) *= glm::length(guides.camera->pixel_to_view(pixel));
    }
  }
}

std::vector<RawGuides> frames_of(const AnalyticShot& shot, bool along_ray) {
  std::vector<RawGuides> frames;
  for (int frame = 0; frame < 3; ++frame) {
    frames.push_back(shot.frame(frame));
    if (along_ray) make_ray_depth(frames.back());
    spoil(frames.back(), static_cast<unsigned>(frame));
  }
  return frames;
}

TEST(Background, IsWhatRenderersWrite) {
  for (const float depth :
       {1e10f, 1.0001e10f, 9.99e9f, 3.4028235e38f, 1e30f, 65504.0f, 0.0f, -1.0f,
        std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_TRUE(is_background(depth)) << depth;
  }
  for (const float depth : {1e-6f, 1.0f, 65472.0f, 65505.0f, 1e6f, 5e8f}) {
    EXPECT_FALSE(is_background(depth)) << depth;
  }
}

TEST(FindDepth, ComparesWithPositions) {
  const AnalyticShot shot;
  for (const bool along_ray : {false, true}) {
    const DepthFit fit = find_depth(frames_of(shot, along_ray));
    EXPECT_TRUE(fit.is_clear) << fit.words;
    EXPECT_EQ(fit.reading.along_ray, along_ray) << fit.words;
    EXPECT_EQ(fit.reading.scale, 1.0);
    EXPECT_LT(std::min(fit.axis_residual, fit.ray_residual), 1e-3);
    EXPECT_GT(std::max(fit.axis_residual, fit.ray_residual), 0.02);
  }
}

TEST(FindDepth, FindsAnotherUnitThanThatOfPositions) {
  const AnalyticShot shot;
  std::vector<RawGuides> frames = frames_of(shot, false);
  for (RawGuides& frame : frames) scale(frame.depth, 100.0);
  const DepthFit fit = find_depth(frames);
  EXPECT_TRUE(fit.is_clear) << fit.words;
  EXPECT_NEAR(fit.reading.scale, 0.01, 1e-5);
}

TEST(FindDepth, ComparesWithNormalsWhereThereAreNoPositions) {
  AnalyticShot shot;
  for (const bool has_wall : {true, false}) {
    shot.has_back_wall = has_wall;
    for (const bool along_ray : {false, true}) {
      std::vector<RawGuides> frames = frames_of(shot, along_ray);
      for (RawGuides& frame : frames) frame.position = {};
      const DepthFit fit = find_depth(frames);
      EXPECT_TRUE(fit.is_clear) << fit.words;
      EXPECT_EQ(fit.reading.along_ray, along_ray) << fit.words;
    }
  }
}

TEST(FindDepth, IsNotClearWithNothingToCompare) {
  const AnalyticShot shot;
  std::vector<RawGuides> frames = frames_of(shot, true);
  for (RawGuides& frame : frames) frame.camera.reset();
  const DepthFit fit = find_depth(frames);
  EXPECT_FALSE(fit.is_clear);
  EXPECT_FALSE(fit.reading.along_ray);
  EXPECT_THAT(fit.words, HasSubstr("no camera"));
}

TEST(FindDepth, IsNotClearThroughALongLens) {
  AnalyticShot shot;
  shot.fov = 1.0f;
  const DepthFit fit = find_depth(frames_of(shot, true));
  EXPECT_FALSE(fit.is_clear) << fit.words;
}

TEST(ApplyDepth, GivesAxisDepthAndInfinity) {
  AnalyticShot shot;
  shot.has_back_wall = false;
  RawGuides frame = shot.frame(1);
  const Plane<float> truth = frame.depth.clone();
  make_ray_depth(frame);
  Plane<float> depth;
  EXPECT_THROW(apply_depth(frame.depth, {true, 1.0}, nullptr, depth), std::invalid_argument);
  apply_depth(frame.depth, {true, 2.0}, &*frame.camera, depth);
  int sky = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      if (truth(x, y) == 1e10f) {
        EXPECT_EQ(depth(x, y), std::numeric_limits<float>::infinity());
        ++sky;
      } else {
        EXPECT_NEAR(depth(x, y), 2.0f * truth(x, y), 1e-5f * truth(x, y));
      }
    }
  }
  EXPECT_GT(sky, 1000);
}

// World normals of the truth as a renderer with that reading writes them.
void encode_normals(RawGuides& guides, bool in_camera_space, const glm::mat3& axes, bool encoded,
                    float flip) {
  for (int y = 0; y < guides.depth.height(); ++y) {
    for (int x = 0; x < guides.depth.width(); ++x) {
      if (is_background(guides.depth(x, y))) continue;
      glm::vec3 n(guides.normal[0](x, y), guides.normal[1](x, y), guides.normal[2](x, y));
      if (in_camera_space) n = guides.camera->world_to_view * n;
      n = flip * (glm::transpose(axes) * n);
      if (encoded) n = 0.5f * n + 0.5f;
      for (int c = 0; c < 3; ++c) guides.normal[c](x, y) = n[c];
    }
  }
}

TEST(FindNormal, FindsEveryReadingInNoise) {
  AnalyticShot shot;
  shot.has_back_wall = false;
  const glm::mat3 identity(1.0f);
  const glm::mat3 z_up = glm::transpose(glm::mat3({1, 0, 0}, {0, 0, 1}, {0, -1, 0}));
  const auto signs = [](float x, float y, float z) {
    return glm::mat3(glm::vec3(x, 0, 0), glm::vec3(0, y, 0), glm::vec3(0, 0, z));
  };
  struct Case {
    bool camera;
    glm::mat3 axes;
  };
  for (const Case& c :
       {Case{false, identity}, Case{false, z_up}, Case{true, signs(1, -1, -1)},
        Case{true, signs(1, -1, 1)}, Case{true, identity}, Case{true, signs(1, 1, -1)}}) {
    for (const bool encoded : {false, true}) {
      for (const float flip : {1.0f, -1.0f}) {
        std::vector<RawGuides> frames;
        for (int frame = 0; frame < 2; ++frame) {
          frames.push_back(shot.frame(frame));
          encode_normals(frames.back(), c.camera, c.axes, encoded, flip);
          for (Plane<float>& plane : frames.back().normal) round_to_half(plane);
          round_to_half(frames.back().depth);
        }
        const NormalFit fit = find_normal(frames, {});
        EXPECT_TRUE(fit.is_clear) << fit.words;
        EXPECT_EQ(fit.reading.in_camera_space, c.camera) << fit.words;
        EXPECT_EQ(fit.reading.is_encoded, encoded) << fit.words;
        EXPECT_EQ(fit.reading.axes, c.axes) << fit.words;
        EXPECT_LT(fit.residual, 5.0) << fit.words;
      }
    }
  }
}

TEST(FindNormal, IsNotClearForNoise) {
  const AnalyticShot shot;
  std::vector<RawGuides> frames = frames_of(shot, false);
  std::mt19937 random(3);
  std::normal_distribution<float> noise;
  for (RawGuides& frame : frames) {
    for (Plane<float>& plane : frame.normal) {
      for (int y = 0; y < plane.height(); ++y) {
        for (int x = 0; x < plane.width(); ++x) plane(x, y) = noise(random);
      }
    }
  }
  EXPECT_FALSE(find_normal(frames, {}).is_clear);
}

TEST(FindNormal, KnowsTheEncodingWithoutACamera) {
  const AnalyticShot shot;
  for (const bool encoded : {false, true}) {
    std::vector<RawGuides> frames;
    frames.push_back(shot.frame(0));
    encode_normals(frames.back(), false, glm::mat3(1.0f), encoded, 1.0f);
    frames.back().camera.reset();
    const NormalFit fit = find_normal(frames, {});
    EXPECT_FALSE(fit.is_clear);
    EXPECT_EQ(fit.reading.is_encoded, encoded) << fit.words;
  }
}

TEST(WorldNormal, IsUnitFacesTheCameraAndTellsItsLength) {
  const AnalyticShot shot;
  const Camera camera = shot.camera(0);
  const glm::vec3 back = glm::transpose(camera.world_to_view) * glm::vec3(0, 0, -1);
  float length = -1.0f;
  const glm::vec3 turned = world_normal(-0.5f * back, {}, &camera, 80, 45, &length);
  EXPECT_GT(glm::dot(turned, back), 0.999f);
  EXPECT_FLOAT_EQ(length, 0.5f);
  EXPECT_EQ(world_normal(glm::vec3(0.0f), {}, &camera, 80, 45, &length), glm::vec3(0.0f));
  EXPECT_EQ(length, 0.0f);
  // At a silhouette: 3 degrees behind.
  const glm::vec3 ray =
      glm::normalize(glm::transpose(camera.world_to_view) * camera.pixel_to_view({80.5f, 45.5f}));
  const glm::vec3 across = glm::normalize(glm::cross(ray, glm::vec3(0, 1, 0)));
  const glm::vec3 laid = world_normal(glm::normalize(across + 0.05f * ray), {}, &camera, 80, 45);
  EXPECT_NEAR(glm::dot(laid, across), 1.0f, 1e-4f);
  EXPECT_LE(glm::dot(laid, ray), 1e-6f);
}

TEST(WorldNormal, IsZeroForWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(world_normal({nan, 0, 1}, {}, nullptr, 0, 0), glm::vec3(0.0f));
  NormalReading encoded;
  encoded.is_encoded = true;
  EXPECT_EQ(world_normal(glm::vec3(0.5f), encoded, nullptr, 0, 0), glm::vec3(0.0f));
  EXPECT_EQ(world_normal({1.0f, 0.5f, 0.5f}, encoded, nullptr, 0, 0), glm::vec3(1, 0, 0));
}

TEST(ApplyNormal, KeepsTheLengthOfTheMean) {
  const AnalyticShot shot;
  RawGuides frame = shot.frame(0);
  for (Plane<float>& plane : frame.normal) scale(plane, -0.25);
  Planes<3> normal, mean;
  apply_normal(frame.normal, {}, &*frame.camera, normal, mean);
  const AnalyticShot::Hit hit = shot.hit(0, 30, 80);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(normal[c](30, 80), hit.normal[c], 1e-6f);
    EXPECT_NEAR(mean[c](30, 80), 0.25f * hit.normal[c], 1e-6f);
  }
}

}  // namespace
}  // namespace eigenlight
