#include "spatial/rivals/pyramid_weights.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace eigenlight {
namespace {

TEST(PyramidWeights, InterpolationMatchesThePaper) {
  for (const int odd : {0, 1}) {
    double sum = 0.0, signed_distance = 0.0;
    for (const int i : {-1, 0, 1}) {
      const auto w = static_cast<double>(pyramid_interpolation(odd, i));
      sum += w;
      signed_distance += w * (4 * i - 2 * odd + 1);
    }
    // Eq. 4: weights of sum 1 whose center of mass is the pixel.
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_NEAR(signed_distance, 0.0, 1e-6);
  }
  EXPECT_FLOAT_EQ(pyramid_interpolation(1, 0), 14.0f / 24.0f);
  EXPECT_FLOAT_EQ(pyramid_interpolation(1, -1), 2.0f / 24.0f);
}

// Eq. 2g, for all four positions of a pixel within its coarser one.
TEST(PyramidWeights, WeightsSumToOne) {
  for (const PyramidTable* table : {&trained_pyramid_table(), &untrained_pyramid_table()}) {
    for (const PyramidWeights& weights : table->octaves()) {
      for (PyramidPass pass : weights) {
        normalize_pass(pass);
        for (int parity = 0; parity < 4; ++parity) {
          double sum = 0.0;
          for (std::size_t i = 0; i < 9; ++i) {
            const int x = static_cast<int>(i) % 3 - 1, y = static_cast<int>(i) / 3 - 1;
            const float wd =
                pyramid_interpolation(parity % 2, x) * pyramid_interpolation(parity / 2, y);
            sum += static_cast<double>(pass.fine[i] + wd * pass.coarse[i]);
          }
          EXPECT_NEAR(sum, 1.0, 1e-4);
        }
      }
    }
  }
}

TEST(PyramidWeights, PassesGrowWithTheLogarithmOfTheRadius) {
  EXPECT_EQ(pyramid_passes(0.0f), 1);
  EXPECT_EQ(pyramid_passes(1.0f), 1);
  EXPECT_EQ(pyramid_passes(2.0f), 2);
  EXPECT_EQ(pyramid_passes(2.1f), 3);
  EXPECT_EQ(pyramid_passes(64.0f), 7);
  EXPECT_EQ(pyramid_passes(1000.0f), 7);
}

// The shares of the levels in a Gaussian of boxes, summed numerically from the definition.
TEST(PyramidWeights, UntrainedShareFollowsTheLevels) {
  const float radius = 23.0f;
  const double c = 2.0 * std::numbers::pi * std::pow(pyramid_sigma(radius), 2.0);
  const auto density = [&](double level) {
    const double area = std::pow(4.0, level);
    return area * area * std::exp(-area / c);  // 4^l |df/dl|, less constants
  };
  const PyramidWeights weights = untrained_pyramid_weights(radius);
  for (int level = 0; level < 4; ++level) {
    double rest = 0.0;
    constexpr double kStep = 1e-3;
    for (double l = level; l < 12.0; l += kStep) rest += density(l + 0.5 * kStep) * kStep;
    EXPECT_NEAR(weights[static_cast<std::size_t>(level)].fine[4] / (density(level) / rest), 1.0,
                1e-4);
  }
}

TEST(PyramidWeights, RadiiBetweenOctavesAreInterpolated) {
  const PyramidTable& table = trained_pyramid_table();
  const float half = std::sqrt(8.0f * 16.0f);
  for (int level = 0; level < 5; ++level) {
    const PyramidPass a = table.at(8.0f, level), b = table.at(16.0f, level),
                      mid = table.at(half, level);
    for (std::size_t i = 0; i < 9; ++i) {
      EXPECT_NEAR(mid.fine[i], 0.5f * (a.fine[i] + b.fine[i]), 1e-5f);
      EXPECT_NEAR(mid.coarse[i], 0.5f * (a.coarse[i] + b.coarse[i]), 1e-5f);
    }
  }
  EXPECT_EQ(table.at(8.0f, 6).fine[4], 1.0f);  // nothing left to blur
  EXPECT_EQ(table.at(0.0f, 0).fine[4], 1.0f);
  EXPECT_EQ(table.at(0.0f, 0).coarse[4], 0.0f);
  EXPECT_EQ(table.weights(64.0f).size(), 7u);
}

TEST(PyramidWeights, RadiusZeroKeepsTheImage) {
  const PyramidPass tiny = trained_pyramid_table().at(1e-4f, 0);
  EXPECT_NEAR(tiny.fine[4], 1.0f, 1e-3f);
}

TEST(PyramidWeights, TableOfAnotherShapeIsRejected) {
  auto octaves = untrained_pyramid_table().octaves();
  octaves[3][1].fine[2] = -0.1f;
  EXPECT_THROW(PyramidTable{octaves}, std::invalid_argument);
  octaves = untrained_pyramid_table().octaves();
  octaves[3][1].fine[4] = 0.0f;
  EXPECT_THROW(PyramidTable{octaves}, std::invalid_argument);
  octaves = untrained_pyramid_table().octaves();
  octaves[3].pop_back();
  EXPECT_THROW(PyramidTable{octaves}, std::invalid_argument);
  octaves.pop_back();
  EXPECT_THROW(PyramidTable{octaves}, std::invalid_argument);
}

TEST(PyramidWeights, SourceOfATableHasItsNumbersAndCommand) {
  const std::string text = pyramid_table_source(untrained_pyramid_table(), "eigenlight some words");
  EXPECT_NE(text.find("// Written by: eigenlight some words\n"), std::string::npos);
  EXPECT_NE(text.find(fmt::format("{:.6e}f", untrained_pyramid_weights(64.0f)[6].fine[4])),
            std::string::npos);
  EXPECT_NE(text.find("// radius 64"), std::string::npos);
}

}  // namespace
}  // namespace eigenlight
