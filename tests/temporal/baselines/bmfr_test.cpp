#include "temporal/baselines/bmfr.h"

#include <Eigen/Dense>

#include "frame/float_traps.h"
#include "temporal/baselines/bmfr_fit.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

glm::vec3 position(const Frame& frame, int x, int y) {
  return frame.camera.to_world(frame.camera.pixel_to_view(glm::vec2(x, y) + 0.5f) *
                               frame.surface.depth(x, y));
}

// A frame of tilted planes whose light is a sum of its features.
struct Scene {
  explicit Scene(Extent extent)
      : frame(make_random_frame({.extent = extent, .disturbed = false, .non_finite = false}, 3)),
        light(make_planes<3>(extent)),
        usable(extent) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        if (frame.surface.id(x, y) == 0) continue;
        usable(x, y) = 1.0f;
        const glm::vec3 at = position(frame, x, y);
        const float facing = frame.surface.normal[1](x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          light[c](x, y) =
              3.0f + 0.3f * at[static_cast<int>(c)] + 0.5f * facing + 0.02f * at.z * at.z;
        }
      }
    }
  }
  Frame frame;
  Planes<3> light;
  Plane<float> usable;
};

TEST(BmfrFit, RecoversASumOfFeatures) {
  for (const Extent extent : {Extent{64, 64}, Extent{65, 17}, Extent{100, 70}}) {
    const Scene scene(extent);
    for (const int jitter : {0, 5, 13}) {
      Planes<3> out = make_planes<3>(extent);
      // Noise on the features, here very little, keeps the fit from being exact.
      bmfr_fit({scene.frame, scene.light, scene.usable, jitter, 1e-4f}, out);
      EXPECT_TRUE(planes_near(out, scene.light, {0.01, 0.0})) << jitter;
    }
  }
}

// A scene of random geometry and light.
Scene random_scene(Extent extent) {
  Scene scene(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      PixelRandom random(5, x, y);
      scene.frame.surface.id(x, y) = 1;
      scene.frame.surface.depth(x, y) = random.between(3.0f, 6.0f);
      scene.usable(x, y) = 1.0f;
      for (auto& plane : scene.frame.surface.normal) plane(x, y) = random.between(-1.0f, 1.0f);
      for (auto& plane : scene.light) plane(x, y) = random.between(0.0f, 2.0f);
    }
  }
  return scene;
}

// Light of all pixels, row by row, fitted to the features by normal equations in double.
Eigen::MatrixXd least_squares(const Scene& scene) {
  const Extent extent = scene.frame.extent();
  const auto pixels = static_cast<Eigen::Index>(extent.pixels());
  Eigen::MatrixXd a(pixels, 10), b(pixels, 3);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const Eigen::Index row = y * extent.width + x;
      const glm::dvec3 at(position(scene.frame, x, y));
      const auto& n = scene.frame.surface.normal;
      a.row(row) << 1.0, n[0](x, y), n[1](x, y), n[2](x, y), at.x, at.y, at.z, at.x * at.x,
          at.y * at.y, at.z * at.z;
      b.row(row) << scene.light[0](x, y), scene.light[1](x, y), scene.light[2](x, y);
    }
  }
  return a * (a.transpose() * a).ldlt().solve(a.transpose() * b);
}

// Offset 3 (8, 0) shifts one block to the corner of the image, and its edges are mirrored: it
// repeats the 8 columns of the image four times and its 16 rows twice, so all pixels have the same
// weight. Noise on the features leaves no singular direction.
TEST(BmfrFit, MatchesTheLeastSquaresSolution) {
  const Scene scene = random_scene({8, 16});
  Planes<3> out = make_planes<3>({8, 16});
  bmfr_fit({scene.frame, scene.light, scene.usable, 3, 1e-5f}, out);
  const Eigen::MatrixXd fit = least_squares(scene);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double wanted = std::max(0.0, fit(y * 8 + x, c));
        EXPECT_NEAR(out[static_cast<std::size_t>(c)](x, y), wanted, 2e-3) << x << ", " << y;
      }
    }
  }
}

TEST(BmfrFit, LeavesOutUnusablePixels) {
  Scene scene({64, 64});
  for (int y = 0; y < 64; ++y) {
    for (int x = y % 3; x < 64; x += 3) {
      scene.usable(x, y) = 0.0f;
      for (auto& plane : scene.light) plane(x, y) = kNan;
    }
  }
  Planes<3> out = make_planes<3>({64, 64});
  bmfr_fit({scene.frame, scene.light, scene.usable, 2, 1e-4f}, out);
  EXPECT_TRUE(planes_near(out, Scene({64, 64}).light, {0.01, 0.0}));
}

TEST(BmfrFit, FewPixelsGiveTheirMean) {
  Scene scene({64, 64});
  scene.usable.fill(0.0f);
  Planes<3> out = make_planes<3>({64, 64});
  // Offset 11 is (-2, -2): blocks start at -18, 14 and 46.
  bmfr_fit({scene.frame, scene.light, scene.usable, 11, 0.01f}, out);
  EXPECT_EQ(out[0](20, 20), 0.0f);
  float mean = 0.0f;
  int count = 0;
  for (int x = 20; x < 30; ++x) {
    if (scene.frame.surface.id(x, 20) == 0) continue;
    scene.usable(x, 20) = 1.0f;
    mean += scene.light[0](x, 20);
    ++count;
  }
  ASSERT_GT(count, 0);
  bmfr_fit({scene.frame, scene.light, scene.usable, 11, 0.01f}, out);
  const bool surface = scene.frame.surface.id(40, 40) != 0;
  EXPECT_NEAR(out[0](40, 40), surface ? mean / static_cast<float>(count) : 0.0f, 1e-5f);
  EXPECT_EQ(out[0](60, 60), 0.0f);
}

TEST(BmfrOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.alpha = 0.0f}), std::invalid_argument);
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.second_alpha = 2.0f}), std::invalid_argument);
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.noise = kNan}), std::invalid_argument);
}

TEST(Bmfr, SmoothsNoise) { expect_smooths_noise("bmfr", {{1.4f, -1.3f}, 0.05, 0.01, 54 + 90 - 1}); }

TEST(Bmfr, KeepsConstantLight) { expect_keeps_constant_light("bmfr", 1e-4f); }

TEST(Bmfr, LeavesOutNonFiniteLight) {
  expect_leaves_out_non_finite_light(
      [](Extent extent) {
        return make_denoiser("bmfr", {extent, 1});
      },
      {.relative = 0.02, .absolute = 0.0});
}

TEST(Bmfr, ResumesWithTheSameBits) { expect_resumes("bmfr"); }
TEST(Bmfr, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("bmfr"); }
TEST(Bmfr, SkippingStillFramesChangesNothing) { expect_still_frames_change_nothing("bmfr"); }
TEST(Bmfr, ThreadCountDoesNotChangeTheBits) { expect_same_bits_on_any_number_of_threads("bmfr"); }
TEST(Bmfr, RunsAtAnySize) { expect_runs_at_any_size("bmfr"); }

}  // namespace
}  // namespace eigenlight
