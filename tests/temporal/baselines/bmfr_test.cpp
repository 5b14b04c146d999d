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

// A frame of light 1 on every surface, each value with uniform noise of variance 1/12.
void fill_with_noise(Frame& frame) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < frame.extent().height; ++y) {
      for (int x = 0; x < frame.extent().width; ++x) {
        if (frame.surface.id(x, y) == 0) continue;
        const std::uint32_t seed = hash_key(static_cast<std::uint32_t>(frame.index), c);
        frame.lights[0].radiance[c](x, y) = PixelRandom(seed, x, y).between(0.5f, 1.5f);
      }
    }
  }
}

double error_of_one(const Planes<3>& out, const Frame& frame) {
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      if (frame.surface.id(x, y) == 0) continue;
      sum += std::pow(static_cast<double>(out[1](x, y)) - 1.0, 2);
      count += 1.0;
    }
  }
  return sum / count;
}

glm::vec3 position(const Frame& frame, int x, int y) {
  return frame.camera.to_world(frame.camera.pixel_to_view(glm::vec2(x, y) + 0.5f) *
                               frame.surface.depth(x, y));
}

// A frame of tilted planes and light that is a sum of its features.
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

TEST(BmfrFit, FindsLightThatIsASumOfFeatures) {
  for (const Extent extent : {Extent{64, 64}, Extent{65, 17}, Extent{100, 70}}) {
    const Scene scene(extent);
    for (const int jitter : {0, 5, 13}) {
      Planes<3> out = make_planes<3>(extent);
      // Noise on the features, here next to none, is what keeps the fit from being exact.
      bmfr_fit({scene.frame, scene.light, scene.usable, jitter, 1e-4f}, out);
      EXPECT_TRUE(planes_near(out, scene.light, {0.01, 0.0})) << jitter;
    }
  }
}

TEST(BmfrFit, IsTheLeastSquaresSolution) {
  // One block, shifted to the image's corner by offset 3 (8, 0) and mirrored at its edges: with no
  // singular direction left by the noise, normal equations in double give the same light.
  const Extent extent{8, 16};
  Scene scene(extent);
  for (auto& plane : scene.frame.surface.normal) plane.fill(0.0f);
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
  Planes<3> out = make_planes<3>(extent);
  bmfr_fit({scene.frame, scene.light, scene.usable, 3, 1e-5f}, out);

  Eigen::MatrixXd a(8 * 16, 10), b(8 * 16, 3);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Eigen::Index row = y * 8 + x;
      const glm::dvec3 at(position(scene.frame, x, y));
      const auto& n = scene.frame.surface.normal;
      a.row(row) << 1.0, n[0](x, y), n[1](x, y), n[2](x, y), at.x, at.y, at.z, at.x * at.x,
          at.y * at.y, at.z * at.z;
      b.row(row) << scene.light[0](x, y), scene.light[1](x, y), scene.light[2](x, y);
    }
  }
  // Rows of the block: columns -8 .. 23 of the image are its 8 columns four times over, rows
  // -16 .. 15 its 16 rows twice, so that every pixel weighs the same.
  const Eigen::MatrixXd fit = a * (a.transpose() * a).ldlt().solve(a.transpose() * b);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double wanted = std::max(0.0, fit(y * 8 + x, c));
        EXPECT_NEAR(out[static_cast<std::size_t>(c)](x, y), wanted, 2e-3) << x << ", " << y;
      }
    }
  }
}

TEST(BmfrFit, LeavesOutPixelsThatAreNotUsable) {
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

TEST(BmfrFit, TakesTheMeanOfFewPixelsAndNothingOfNone) {
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

TEST(BmfrOptions, RefusesWhatIsOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.alpha = 0.0f}), std::invalid_argument);
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.second_alpha = 2.0f}), std::invalid_argument);
  EXPECT_THROW(Bmfr({{8, 8}, 1}, {.noise = kNan}), std::invalid_argument);
}

TEST(Bmfr, MakesNoisyLightSmooth) {
  AnalyticOptions options{.extent = {96, 54}, .frames = 12};
  options.slide = {1.4f, -1.3f};
  options.sky_columns = 6;
  options.edit = fill_with_noise;
  AnalyticSource source(options);
  Bmfr bmfr({options.extent, 1});
  double first = 0.0, last = 0.0;
  for (int frame = 0; frame < 12; ++frame) {
    const Planes<3>* out = bmfr.step(source);
    last = error_of_one(*out, bmfr.frame());
    if (frame == 0) first = last;
    EXPECT_EQ((*out)[0](2, 30), 0.0f);
  }
  EXPECT_LT(first, 0.05 / 12.0);
  EXPECT_LT(last, 0.01 / 12.0);
  EXPECT_EQ(bmfr.age()(2, 30), 0.0f);
  EXPECT_NEAR(bmfr.age()(50, 50), 12.0f, 0.01f);
  EXPECT_EQ(bmfr.report().surface_pixels, 90 * 54);
  EXPECT_EQ(bmfr.report().new_pixels, 54 + 90 - 1);
}

TEST(Bmfr, KeepsConstantLightAsItIs) {
  AnalyticOptions options{.frames = 10, .noise = 0.0f};
  options.edit = [](Frame& frame) {
    for (auto& plane : frame.lights[0].radiance) plane.fill(0.75f);
  };
  options.slide = {0.5f, 0.25f};
  const Planes<3> out = last_picture("bmfr", options);
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 64; ++x) ASSERT_NEAR(out[1](x, y), 0.75f, 1e-4f);
  }
}

TEST(Bmfr, LeavesOutWhatIsNotFinite) {
  AnalyticOptions clean{.frames = 6, .noise = 0.0f};
  clean.slide = {0.5f, 0.5f};
  AnalyticOptions broken = clean;
  broken.edit = [](Frame& frame) {
    if (frame.index == 0) frame.lights[0].radiance[1](30, 20) = kNan;
    if (frame.index == 3)
      frame.lights[0].radiance[2](40, 10) = std::numeric_limits<float>::infinity();
  };
  AnalyticSource source(broken), untouched(clean);
  Bmfr bmfr({broken.extent, 1}), other({clean.extent, 1});
  for (int frame = 0; frame < 6; ++frame) {
    const Planes<3>* out = bmfr.step(source);
    const Planes<3>* expected = other.step(untouched);
    EXPECT_EQ(bmfr.report().non_finite_pixels, frame == 0 || frame == 3 ? 1 : 0);
    EXPECT_TRUE(all_finite(*out));
    if (frame == 0) {
      EXPECT_EQ(bmfr.age()(30, 20), 0.0f);
      EXPECT_GT((*out)[1](30, 20), 0.0f);
    }
    const double usual = relative_error(*expected, untouched, other.frame());
    EXPECT_LT(relative_error(*out, source, bmfr.frame()), usual * 1.02) << frame;
  }
}

TEST(Bmfr, GoesOnAfterARestart) { expect_resumes("bmfr"); }
TEST(Bmfr, ForgetsAtCuts) { expect_forgets_at_cuts("bmfr"); }
TEST(Bmfr, GivesTheSameWhetherOrNotItSkipsStillFrames) {
  expect_still_frames_change_nothing("bmfr");
}
TEST(Bmfr, GivesTheSameBitsOnAnyNumberOfThreads) {
  expect_same_bits_on_any_number_of_threads("bmfr");
}
TEST(Bmfr, RunsAtAnySize) { expect_runs_at_any_size("bmfr"); }

}  // namespace
}  // namespace eigenlight
