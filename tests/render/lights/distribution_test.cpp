#include "render/lights/distribution.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace eigenlight {
namespace {

TEST(Distribution, SamplesAreProportionalToWeights) {
  const std::array<float, 5> weights{1.0f, 0.0f, 3.0f, 4.0f, 0.0f};
  const Distribution d(weights);
  EXPECT_DOUBLE_EQ(d.total(), 8.0);
  std::array<int, 5> counts{};
  double remainder = 0.0;
  const int n = 8000;
  for (int i = 0; i < n; ++i) {
    const auto choice = d.sample((static_cast<float>(i) + 0.5f) / static_cast<float>(n));
    ++counts[choice.index];
    EXPECT_FLOAT_EQ(choice.probability, weights[choice.index] / 8.0f);
    EXPECT_GE(choice.remainder, 0.0f);
    EXPECT_LT(choice.remainder, 1.0f);
    remainder += static_cast<double>(choice.remainder) / n;
  }
  EXPECT_EQ(counts, (std::array<int, 5>{1000, 0, 3000, 4000, 0}));
  EXPECT_NEAR(remainder, 0.5, 1e-3);
}

TEST(Distribution, LargestNumberSelectsTheLastPositiveWeight) {
  const std::array<float, 3> weights{0.1f, 0.7f, 0.0f};
  EXPECT_EQ(Distribution(weights).sample(0x1.fffffep-1f).index, 1U);
}

TEST(Distribution, InvalidWeightsAreNeverSampled) {
  const std::array<float, 4> weights{-1.0f, std::numeric_limits<float>::quiet_NaN(), 2.0f,
                                     std::numeric_limits<float>::infinity()};
  const Distribution d(weights);
  EXPECT_DOUBLE_EQ(d.total(), 2.0);
  EXPECT_EQ(d.sample(0.0f).index, 2U);
  EXPECT_EQ(d.sample(0.99f).index, 2U);
}

TEST(Distribution, TotalIsZeroWithoutWeights) {
  EXPECT_EQ(Distribution().total(), 0.0);
  const std::array<float, 2> weights{0.0f, 0.0f};
  EXPECT_EQ(Distribution(weights).total(), 0.0);
}

}  // namespace
}  // namespace eigenlight
