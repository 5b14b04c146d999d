#include "sequences/conventions/checks.h"

#include <gmock/gmock.h>

#include <random>

#include "sequences/conventions/motion.h"
#include "tests/sequences/conventions/analytic_shot.h"

namespace eigenlight {
namespace {

using ::testing::HasSubstr;

// Light with the heavy-tailed noise of a few paths: mostly small, seldom large.
Planes<3> noisy_light(Extent extent, unsigned seed, float spread = 1.0f) {
  std::mt19937 random(seed);
  std::lognormal_distribution<float> noise(0.0f, spread);
  Planes<3> light = make_planes<3>(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const float value = noise(random) * (0.5f + 0.004f * static_cast<float>(x + y));
      for (int c = 0; c < 3; ++c) light[c](x, y) = value;
    }
  }
  return light;
}

// As a pixel filter of twice the width, or `rounds` of a denoiser.
Planes<3> blurred(const Planes<3>& light, int rounds) {
  Planes<3> from = make_planes<3>(light[0].extent()), to = make_planes<3>(light[0].extent());
  copy_planes(light, from);
  const Extent extent = light[0].extent();
  for (int round = 0; round < rounds; ++round) {
    for (int c = 0; c < 3; ++c) {
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) {
          const int x1 = std::min(x + 1, extent.width - 1), y1 = std::min(y + 1, extent.height - 1);
          to[c](x, y) = 0.25f * (from[c](x, y) + from[c](x1, y) + from[c](x, y1) + from[c](x1, y1));
        }
      }
    }
    copy_planes(to, from);
  }
  return to;
}

RawGuides flat_guides(Extent extent) {
  RawGuides guides;
  guides.depth = Plane<float>(extent);
  guides.depth.fill(2.0f);
  return guides;
}

constexpr Extent kExtent{120, 80};

TEST(FrozenSeeds, AreSeenWherePixelsStandStill) {
  const Planes<3> before = noisy_light(kExtent, 1), now = noisy_light(kExtent, 1);
  Planes<2> motion = make_planes<2>(kExtent);
  const auto line = check_frozen_seeds(before, now, motion);
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, HasSubstr("frozen seeds: 100 %"));
  EXPECT_THAT(*line, HasSubstr("seed of its own"));
  EXPECT_TRUE(check_frozen_seeds(before, now, {}));
  motion[0].fill(1.0f);  // nothing stands still
  EXPECT_FALSE(check_frozen_seeds(before, now, motion));
}

TEST(FrozenSeeds, AreNotSeenInFreshNoise) {
  const Planes<2> still = make_planes<2>(kExtent);
  EXPECT_FALSE(check_frozen_seeds(noisy_light(kExtent, 1), noisy_light(kExtent, 2), still));
  const Planes<3> dark = make_planes<3>(kExtent);
  EXPECT_FALSE(check_frozen_seeds(dark, dark, still));
  EXPECT_THROW((void)check_frozen_seeds(make_planes<3>({9, 9}), dark, still),
               std::invalid_argument);
}

TEST(NoiseCorrelation, IsZeroForIndependentNoise) {
  const auto correlation = noise_correlation(noisy_light(kExtent, 3), flat_guides(kExtent));
  ASSERT_TRUE(correlation);
  EXPECT_NEAR(*correlation, 0.0, 0.02);
  EXPECT_FALSE(check_correlated_noise(noisy_light(kExtent, 3), flat_guides(kExtent)));
}

TEST(NoiseCorrelation, IsSeenInWideFiltersAndDenoisedLight) {
  const Planes<3> wide = blurred(noisy_light(kExtent, 3), 1);
  const auto line = check_correlated_noise(wide, flat_guides(kExtent));
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, HasSubstr("correlated noise"));
  const auto smooth =
      check_correlated_noise(blurred(noisy_light(kExtent, 3), 8), flat_guides(kExtent));
  ASSERT_TRUE(smooth);
  EXPECT_THAT(*smooth, HasSubstr("denoised already"));
}

TEST(NoiseCorrelation, IsNotMeasuredAcrossEdges) {
  RawGuides guides = flat_guides(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) guides.depth(x, y) = (x / 2) % 2 != 0 ? 2.0f : 5.0f;
  }
  EXPECT_FALSE(noise_correlation(noisy_light(kExtent, 3), guides));
}

// Only blue has correlated noise: who weighs it little hardly sees it.
TEST(CorrelatedNoise, IsThatOfLuminanceInTheFilesOwnPrimaries) {
  Planes<3> light = noisy_light(kExtent, 3);
  const Planes<3> smooth = blurred(noisy_light(kExtent, 4), 1);
  light[2].copy_from(smooth[2]);
  const RawGuides guides = flat_guides(kExtent);
  const auto blue = noise_correlation(light, guides, {0.0, 0.0, 1.0});
  const auto green = noise_correlation(light, guides, {0.0, 1.0, 0.0});
  ASSERT_TRUE(blue && green);
  EXPECT_GT(*blue, 0.3);
  EXPECT_NEAR(*green, 0.0, 0.05);
}

TEST(NoisyFeature, IsNoisierThanTheLight) {
  const Planes<3> light = noisy_light(kExtent, 1, 0.1f), albedo = noisy_light(kExtent, 2, 0.5f);
  const auto line = check_noisy_feature(albedo, light, "albedo");
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, HasSubstr("albedo is noisier than the light"));
  EXPECT_FALSE(check_noisy_feature(light, albedo, "albedo"));
}

TEST(Cut, IsSeenWhereNothingIsFoundAgain) {
  const AnalyticShot shot;
  AnalyticShot other;
  other.has_spheres = false;
  other.fov = 25.0f;
  RawGuides now = shot.frame(4), before = shot.frame(3), elsewhere = other.frame(40);
  Planes<2> motion;
  apply_motion(now, &before, {0, 1.0, 1.0, true}, motion);
  for (RawGuides* frame : {&now, &before, &elsewhere}) spoil(*frame, 7);
  EXPECT_FALSE(is_cut(now, before, motion));
  EXPECT_FALSE(is_cut(now, before, {}));
  EXPECT_TRUE(is_cut(now, elsewhere, motion));
  EXPECT_TRUE(is_cut(elsewhere, before, {}));
}

}  // namespace
}  // namespace eigenlight
