#include "temporal/baselines/svgf.h"

#include "frame/float_traps.h"
#include "tests/reference/svgf.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

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

// Random light and variance on a random frame; a tenth of the surface is not known.
struct Scene {
  explicit Scene(Extent extent)
      : frame(make_random_frame({.extent = extent, .disturbed = false, .non_finite = false}, 3)),
        image(extent),
        known(extent) {
    copy_planes(frame.lights[0].radiance, image.color);
    image.variance = random_plane(extent, 5, 0.0f, 0.4f);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        const bool has = frame.surface.id(x, y) != 0 && PixelRandom(9, x, y).uniform() > 0.1f;
        known(x, y) = has ? 1.0f : 0.0f;
        for (auto& plane : image.color) plane(x, y) *= known(x, y);
        image.variance(x, y) *= known(x, y);
      }
    }
  }
  Frame frame;
  SvgfImage image;
  Plane<float> known;
};

TEST(SvgfPass, AgreesWithItsTwinOnEveryInstructionSet) {
  for (const Extent extent : kSweepExtents) {
    const Scene scene(extent);
    for (const int step : {1, 4}) {
      const SvgfWeights weights{.depth_slopes = 1.5f, .normal_squarings = 5};
      const SvgfPass pass{scene.frame, weights, step, scene.known};
      SvgfImage wanted(extent);
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const reference::SvgfPixel pixel = reference::svgf_pass(pass, scene.image, {x, y});
          for (std::size_t c = 0; c < 3; ++c) {
            wanted.color[c](x, y) = static_cast<float>(pixel.color[c]);
          }
          wanted.variance(x, y) = static_cast<float>(pixel.variance);
        }
      }
      for_each_target([&] {
        SvgfImage out(extent);
        for_each_tile(stage_tiles(extent),
                      [&](const Rect& tile) { svgf_pass_tile(pass, scene.image, tile, out); });
        EXPECT_TRUE(planes_near(out.color, wanted.color, {2e-4, 1e-5})) << step;
        EXPECT_TRUE(planes_near(out.variance, wanted.variance, {4e-4, 1e-6})) << step;
      });
    }
  }
}

TEST(SvgfGeometryWeight, IsThatOfThePass) {
  const Scene scene({40, 24});
  const SvgfWeights weights;
  // With one other known pixel and any luminance, a pass gives that pixel's share away.
  const SvgfWeights blind{.luminance_sigmas = 100.0f};
  Plane<float> known({40, 24});
  SvgfImage image({40, 24}), out({40, 24});
  image.variance.fill(1e6f);
  int compared = 0;
  for (int x = 3; x < 37; ++x) {
    const glm::ivec2 p(x, 12), q(x + 1, 13);
    if (scene.frame.surface.id(p.x, p.y) == 0 || scene.frame.surface.id(q.x, q.y) == 0) continue;
    known.fill(0.0f);
    known(p.x, p.y) = known(q.x, q.y) = 1.0f;
    for (auto& plane : image.color) plane.fill(0.0f);
    for (auto& plane : image.color) plane(q.x, q.y) = 1.0f;
    for_each_tile(stage_tiles({40, 24}), [&](const Rect& tile) {
      svgf_pass_tile({scene.frame, blind, 1, known}, image, tile, out);
    });
    const float weight = svgf_geometry_weight(scene.frame, weights, p, q);
    const float other = weight / 16.0f, own = 9.0f / 64.0f;
    EXPECT_NEAR(out.color[1](p.x, p.y), other / (own + other), 1e-4f) << x;
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

TEST(SvgfOptions, RefusesWhatIsOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  const auto refuses = [](auto change) {
    SvgfOptions options;
    change(options);
    EXPECT_THROW(Svgf({{8, 8}, 1}, options), std::invalid_argument);
  };
  refuses([](SvgfOptions& o) { o.alpha = 0.0f; });
  refuses([](SvgfOptions& o) { o.moments_alpha = 1.5f; });
  refuses([](SvgfOptions& o) { o.passes = 7; });
  refuses([](SvgfOptions& o) { o.feedback = 6; });
  refuses([](SvgfOptions& o) { o.weights.depth_slopes = kNan; });
  refuses([](SvgfOptions& o) { o.weights.normal_squarings = 11; });
  refuses([](SvgfOptions& o) { o.weights.luminance_sigmas = 0.0f; });
}

TEST(Svgf, MakesNoisyLightSmooth) {
  AnalyticOptions options{.extent = {96, 54}, .frames = 12};
  options.slide = {3.4f, -3.3f};
  options.sky_columns = 6;
  options.edit = fill_with_noise;
  AnalyticSource source(options);
  Svgf svgf({options.extent, 1});
  double first = 0.0, last = 0.0;
  for (int frame = 0; frame < 12; ++frame) {
    const Planes<3>* out = svgf.step(source);
    last = error_of_one(*out, svgf.frame());
    if (frame == 0) first = last;
    EXPECT_EQ((*out)[0](2, 30), 0.0f);
  }
  EXPECT_LT(first, 0.01 / 12.0);
  EXPECT_LT(last, 0.002 / 12.0);
  EXPECT_EQ(svgf.age()(2, 30), 0.0f);
  EXPECT_NEAR(svgf.age()(50, 50), 12.0f, 0.01f);
  EXPECT_EQ(svgf.report().surface_pixels, 90 * 54);
  // The slide uncovers four columns and rows, of which 3 x 3 pixels around find the inner two.
  EXPECT_EQ(svgf.report().new_pixels, 2 * 54 + 2 * 90 - 4);
}

TEST(Svgf, TakesAFifthOfEachFrameOnceOld) {
  // Without passes that mix pixels (a luminance edge of no width) and noise, a step of light comes
  // through as 1 - 0.8^n.
  AnalyticOptions options{.extent = {16, 9}, .frames = 40, .noise = 0.0f};
  options.gain = [](int frame) { return frame < 36 ? 1.0f : 2.0f; };
  AnalyticSource source(options);
  Svgf svgf({options.extent, 1},
            {.passes = 1, .feedback = 0, .weights = {.luminance_sigmas = 1e-6f}});
  for (int frame = 0; frame < 40; ++frame) {
    const Planes<3>* out = svgf.step(source);
    const float before = source.truth({8, 4}, 0, 0);
    const float share = frame < 36 ? 0.0f : 1.0f - std::pow(0.8f, static_cast<float>(frame - 35));
    if (frame >= 4) {
      EXPECT_NEAR((*out)[0](8, 4), before * (1.0f + share), 1e-3f) << frame;
    }
  }
}

TEST(Svgf, KeepsConstantLightAsItIs) {
  AnalyticOptions options{.frames = 10, .noise = 0.0f};
  options.edit = [](Frame& frame) {
    for (auto& plane : frame.lights[0].radiance) plane.fill(0.75f);
  };
  options.slide = {0.5f, 0.25f};
  const Planes<3> out = last_picture("svgf", options);
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 64; ++x) ASSERT_NEAR(out[1](x, y), 0.75f, 1e-5f);
  }
}

TEST(Svgf, LeavesOutWhatIsNotFinite) {
  AnalyticOptions clean{.frames = 6, .noise = 0.0f};
  clean.slide = {0.5f, 0.5f};
  AnalyticOptions broken = clean;
  broken.edit = [](Frame& frame) {
    if (frame.index == 0) frame.lights[0].radiance[1](30, 20) = kNan;
    if (frame.index == 3)
      frame.lights[0].radiance[2](40, 10) = std::numeric_limits<float>::infinity();
  };
  AnalyticSource source(broken), untouched(clean);
  Svgf svgf({broken.extent, 1}), other({clean.extent, 1});
  for (int frame = 0; frame < 6; ++frame) {
    const Planes<3>* out = svgf.step(source);
    const Planes<3>* expected = other.step(untouched);
    EXPECT_EQ(svgf.report().non_finite_pixels, frame == 0 || frame == 3 ? 1 : 0);
    EXPECT_TRUE(all_finite(*out));
    if (frame == 0) {
      // Filled from its surroundings, but of no age.
      EXPECT_NEAR((*out)[1](30, 20), source.truth({30, 20}, 1, 0), 0.1f);
      EXPECT_EQ(svgf.age()(30, 20), 0.0f);
    }
    const double usual = relative_error(*expected, untouched, other.frame());
    EXPECT_LT(relative_error(*out, source, svgf.frame()), usual * 1.02) << frame;
  }
}

TEST(Svgf, GoesOnAfterARestart) { expect_resumes("svgf"); }
TEST(Svgf, ForgetsAtCuts) { expect_forgets_at_cuts("svgf"); }
TEST(Svgf, GivesTheSameWhetherOrNotItSkipsStillFrames) {
  expect_still_frames_change_nothing("svgf");
}
TEST(Svgf, GivesTheSameBitsOnAnyNumberOfThreads) {
  expect_same_bits_on_any_number_of_threads("svgf");
}
TEST(Svgf, RunsAtAnySize) { expect_runs_at_any_size("svgf"); }

}  // namespace
}  // namespace eigenlight
