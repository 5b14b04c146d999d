#include "frame/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <functional>

namespace eigenlight {
namespace {

constexpr int kBins = 64;
constexpr int kDraws = 64000;
// Chi-square with 63 degrees of freedom: mean 63, standard deviation sqrt(126). Seeds are fixed, so
// five deviations either way fail on a changed generator only.
constexpr double kMean = 63.0;
constexpr double kSpread = 11.225;

double chi_square(const std::function<std::uint32_t(std::uint32_t)>& draw) {
  std::array<int, kBins> counts{};
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    ++counts[static_cast<std::size_t>(to_unit(draw(i)) * kBins)];
  }
  constexpr double kExpected = static_cast<double>(kDraws) / kBins;
  double sum = 0.0;
  for (const int count : counts) sum += (count - kExpected) * (count - kExpected) / kExpected;
  return sum;
}

TEST(Random, HashIsUniformAlongEachWordOfItsKey) {
  const std::array<std::function<std::uint32_t(std::uint32_t)>, 5> draws{
      {[](std::uint32_t i) { return mix32(i); },
       [](std::uint32_t i) { return hash_key(i, 3u, 5u); },
       [](std::uint32_t i) { return hash_key(7u, i, 5u); },
       [](std::uint32_t i) { return hash_key(7u, 3u, i); },
       [](std::uint32_t i) { return hash_key(0u, i % 320, i / 320, 1u, 0u); }}};
  for (const auto& draw : draws) EXPECT_NEAR(chi_square(draw), kMean, 5.0 * kSpread);
}

TEST(Random, HashesOfNeighboringKeysAreIndependent) {
  // Pairs of pixel and its right neighbor, 8 x 8 bins: 63 degrees of freedom again.
  EXPECT_NEAR(chi_square([](std::uint32_t i) {
                const std::uint32_t a = hash_key(1u, i, 2u), b = hash_key(1u, i + 1, 2u);
                return (a & 0xe0000000u) | ((b & 0xe0000000u) >> 3);
              }),
              kMean, 5.0 * kSpread);
}

TEST(Random, EachInputBitFlipsHalfOfTheOutput) {
  for (int bit = 0; bit < 32; ++bit) {
    int flipped = 0;
    for (std::uint32_t i = 0; i < 2000; ++i) {
      flipped += std::popcount(mix32(i * 2654435761u) ^ mix32((i * 2654435761u) ^ (1u << bit)));
    }
    // 64000 fair coins: standard deviation 126.5.
    EXPECT_NEAR(flipped, 32000, 700) << "bit " << bit;
  }
}

TEST(Random, OrderOfWordsMatters) {
  EXPECT_NE(hash_key(1u, 2u), hash_key(2u, 1u));
  EXPECT_NE(hash_key(0u), hash_key(0u, 0u));
  EXPECT_NE(hash_key(0u, 0u), hash_key(0u, 0u, 0u));
}

TEST(Random, UnitIntervalIsHalfOpen) {
  EXPECT_EQ(to_unit(0u), 0.0f);
  EXPECT_LT(to_unit(0xffffffffu), 1.0f);
  EXPECT_EQ(to_unit(0x80000000u), 0.5f);
}

}  // namespace
}  // namespace eigenlight
