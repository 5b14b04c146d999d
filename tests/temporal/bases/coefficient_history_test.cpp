#include "temporal/bases/coefficient_history.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/reference/coefficients.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{65, 33};  // 3 x 2 tiles

struct Memory {
  explicit Memory(int bases)
      : memory(kExtent, bases), coefficients(kExtent, bases), learning_rates(kExtent, bases) {}
  // The same coefficients in all tiles; delta[0] is a gain and does not count.
  void learn(const std::vector<float>& delta) {
    for (int i = 0; i < coefficients.grid().count(); ++i) {
      for (std::size_t k = 0; k < delta.size(); ++k) coefficients.tile(i)[k] = delta[k];
    }
    memory.learn(coefficients, learning_rates);
  }
  // q of the last tile.
  [[nodiscard]] double q(std::size_t k) const {
    const auto tile = learning_rates.tile(learning_rates.grid().count() - 1);
    return static_cast<double>(tile[k]) + (k == 0 ? 1.0 : 0.0);
  }
  CoefficientHistory memory;
  CoefficientField coefficients, learning_rates;
};

TEST(CoefficientHistory, SingleBasisLearnsLikeARunningMean) {
  Memory m(3);
  for (int frame = 0; frame < 100; ++frame) {
    m.learn({0.7f, 0.0f, 0.0f});
    EXPECT_EQ(m.memory.active(), 1);
    EXPECT_NEAR(m.q(0), 1.0, 1e-7);
    EXPECT_EQ(m.q(1), 0.0);
  }
}

// R, M and q = M^-1 c written out, for a basis that is born after ten frames.
TEST(CoefficientHistory, LearningRatesMatchTheReference) {
  Memory m(2);
  for (int frame = 0; frame < 10; ++frame) m.learn({0, 0});
  ASSERT_EQ(m.memory.free_slot(), 1);
  m.memory.born(1);
  EXPECT_EQ(m.memory.active(), 2);
  constexpr double kLambda = 1.0 - 1.0 / 64.0;
  double r00 = 0.0, r01 = 0.0, r11 = 8.0;
  for (int frame = 0; frame < 10; ++frame) r00 = kLambda * r00 + 1.0;
  for (const float c : {0.5f, -1.0f, 2.0f, 0.25f, 0.0f}) {
    m.learn({0, c});
    r00 = kLambda * r00 + 1.0;
    r01 = kLambda * r01 + c;
    r11 = kLambda * r11 + static_cast<double>(c) * c;
    const auto inverse =
        reference::inverse({{1.0, r01 / r00}, {r01 / r00, r11 / r00 + 1e-3 / r00}});
    EXPECT_NEAR(m.q(0), inverse[0][0] + inverse[0][1] * c, 1e-5);
    EXPECT_NEAR(m.q(1), inverse[1][0] + inverse[1][1] * c, 1e-5);
    EXPECT_NEAR(m.memory.expected()[1], r11 / r00, 1e-12);
    EXPECT_EQ(m.memory.expected()[0], 0.0);
    // A step moves this frame's prediction, and never beyond the residual: h s / (n + h s) < 1.
    EXPECT_GT(m.q(0) + c * m.q(1), 0.99);
  }
}

TEST(CoefficientHistory, BirthsAreSpacedAndLimitedBySlots) {
  Memory m(3);
  EXPECT_EQ(m.memory.free_slot(), 0);  // nothing is known yet
  int births = 0;
  for (int frame = 0; frame < 12; ++frame) {
    m.learn({0, 1.0f, 1.0f});
    const int slot = m.memory.free_slot();
    if (slot == 0) continue;
    EXPECT_EQ(slot, births + 1);
    m.memory.born(slot);
    EXPECT_EQ(m.memory.free_slot(), 0);
    ++births;
  }
  EXPECT_EQ(births, 2);
  EXPECT_EQ(m.memory.active(), 3);
}

TEST(CoefficientHistory, UnusedBasesAreRetired) {
  Memory m(3);
  for (int frame = 0; frame < 5; ++frame) m.learn({0, 0, 0});
  m.memory.born(1);
  int frames = 0;
  for (; m.memory.retire().empty(); ++frames) {
    ASSERT_LT(frames, 1000);
    m.learn({0, 0, 0});
  }
  // 8 frames' worth fall below 0.05 at a rate of 1/64: ln(160) * 64.
  EXPECT_NEAR(frames, 322, 3);
  EXPECT_EQ(m.memory.active(), 1);
  EXPECT_EQ(m.memory.expected()[1], m.memory.expected()[4]);
  m.memory.born(1);
  for (int frame = 0; frame < 1000; ++frame) {
    m.learn({0, 0.3f, 0});
    ASSERT_TRUE(m.memory.retire().empty());
  }
}

TEST(CoefficientHistory, StateRoundTripsAndResetClears) {
  Memory m(3), other(3), fresh(3);
  for (int frame = 0; frame < 6; ++frame) m.learn({0, 0, 0});
  m.memory.born(1);
  m.learn({0, 0.5f, 0});
  StateWriter out;
  m.memory.save(out);
  StateReader in({out.bytes().data(), out.bytes().size()});
  other.memory.load(in);
  in.finish();
  m.learn({0, -0.25f, 0});
  other.learn({0, -0.25f, 0});
  EXPECT_EQ(other.q(0), m.q(0));
  EXPECT_EQ(other.q(1), m.q(1));
  EXPECT_EQ(other.memory.active(), 2);
  m.memory.reset();
  m.learn({0, 0, 0});
  fresh.learn({0, 0, 0});
  EXPECT_EQ(m.q(0), fresh.q(0));
  EXPECT_EQ(m.memory.active(), 1);
}

}  // namespace
}  // namespace eigenlight
