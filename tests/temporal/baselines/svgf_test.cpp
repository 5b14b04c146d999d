#include "temporal/baselines/svgf.h"

#include "frame/float_traps.h"
#include "tests/reference/svgf.h"
#include "tests/support/compare.h"
#include "tests/support/denoiser_checks.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Random light and variance on a random frame; a tenth of the surface is unknown.
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

EL_KERNEL_TEST(SvgfPass, MatchesTheReference) {
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
    on_every_target([&] {
      SvgfImage out(extent);
      for_each_tile(stage_tiles(extent),
                    [&](const Rect& tile) { svgf_pass_tile(pass, scene.image, tile, out); });
      EXPECT_TRUE(planes_near(out.color, wanted.color, {2e-4, 1e-5})) << step;
      EXPECT_TRUE(planes_near(out.variance, wanted.variance, {4e-4, 1e-6})) << step;
    });
  }
}

TEST(SvgfGeometryWeight, MatchesThePass) {
  const Scene scene({40, 24});
  const SvgfWeights weights;
  // With one other known pixel and any luminance, the result of a pass is the share of that pixel.
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

TEST(SvgfOptions, RejectsValuesOutOfRange) {
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

// The slide uncovers four columns and rows; windows of 3 x 3 pixels find history for the inner two.
TEST(Svgf, SmoothsNoise) {
  expect_smooths_noise("svgf", {{3.4f, -3.3f}, 0.01, 0.002, 2 * 54 + 2 * 90 - 4});
}

TEST(Svgf, OldPixelsTakeAFifthOfEachFrame) {
  // Without noise and without passes that mix pixels (a luminance edge of no width), a step of
  // light arrives as 1 - 0.8^n.
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

TEST(Svgf, KeepsConstantLight) { expect_keeps_constant_light("svgf", 1e-5f); }

TEST(Svgf, LeavesOutNonFiniteLight) {
  expect_leaves_out_non_finite_light(
      [](Extent extent) {
        return make_denoiser("svgf", {extent, 1});
      },
      {.relative = 0.02, .absolute = 0.0});
}

TEST(Svgf, ResumesWithTheSameBits) { expect_resumes("svgf"); }
TEST(Svgf, ForgetsHistoryAtCuts) { expect_forgets_at_cuts("svgf"); }
TEST(Svgf, SkippingStillFramesChangesNothing) { expect_still_frames_change_nothing("svgf"); }
TEST(Svgf, ThreadCountDoesNotChangeTheBits) { expect_same_bits_on_any_number_of_threads("svgf"); }
TEST(Svgf, RunsAtAnySize) { expect_runs_at_any_size("svgf"); }

}  // namespace
}  // namespace eigenlight
