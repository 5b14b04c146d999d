#include "render/paths/sampler.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "frame/random.h"

namespace eigenlight {
namespace {

/// The 2D point of sample i in one pair of dimensions.
glm::vec2 point(std::uint32_t key, std::uint32_t i, int pair) {
  Sampler sampler(key, i);
  glm::vec2 p(0.0f);
  for (int k = 0; k <= pair; ++k) p = sampler.next_2d();
  return p;
}

// Definition of a (0, m, 2)-net: every box of area 2^-m whose sides are powers of two contains one
// of the 2^m points. It applies to each aligned block of a (0, 2)-sequence.
TEST(Sampler, EachElementaryBoxContainsOnePoint) {
  const int m = 6;
  for (const std::uint32_t key : {0U, 77U, 0xdeadbeefU}) {
    for (int pair = 0; pair < 3; ++pair) {
      for (const std::uint32_t first : {0U, 64U, 640U}) {
        for (int split = 0; split <= m; ++split) {
          std::set<std::pair<int, int>> boxes;
          for (std::uint32_t i = 0; i < 64; ++i) {
            const glm::vec2 p = point(key, first + i, pair);
            boxes.emplace(static_cast<int>(p.x * static_cast<float>(1 << split)),
                          static_cast<int>(p.y * static_cast<float>(1 << (m - split))));
          }
          EXPECT_EQ(boxes.size(), 64U) << "key " << key << " pair " << pair << " split " << split;
        }
      }
    }
  }
}

TEST(Sampler, KeysAndDimensionPairsAreUncorrelated) {
  const int count = 20000;
  double mean = 0.0, across_keys = 0.0, across_pairs = 0.0, across_samples = 0.0;
  for (int k = 0; k < count; ++k) {
    const std::uint32_t key = hash_key(3U, k);
    const double a = point(key, 0, 0).x - 0.5;
    mean += a;
    across_keys += a * (point(hash_key(3U, k + 1), 0, 0).x - 0.5);
    across_pairs += a * (point(key, 0, 1).x - 0.5);
    across_samples += a * (point(key, 0, 0).y - 0.5);
  }
  // Standard deviations of the means: 1 / sqrt(12 n) = 0.002 and 1 / (12 sqrt(n)) = 0.0006.
  EXPECT_NEAR(mean / count, 0.0, 0.009);
  EXPECT_NEAR(across_keys / count, 0.0, 0.003);
  EXPECT_NEAR(across_pairs / count, 0.0, 0.003);
  EXPECT_NEAR(across_samples / count, 0.0, 0.003);
}

TEST(Sampler, SameKeyAndIndexGiveTheSameNumbers) {
  EXPECT_EQ(point(5, 9, 2), point(5, 9, 2));
  EXPECT_NE(point(5, 9, 2), point(6, 9, 2));
  EXPECT_NE(point(5, 9, 2), point(5, 10, 2));
}

}  // namespace
}  // namespace eigenlight
