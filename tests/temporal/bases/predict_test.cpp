#include "temporal/bases/predict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frame/float_traps.h"
#include "tests/reference/predict.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

CoefficientField random_coefficients(Extent extent, int bases) {
  CoefficientField field(extent, bases);
  for (int i = 0; i < field.grid().count(); ++i) {
    PixelRandom random(3, i, 0);
    for (float& delta : field.tile(i)) delta = random.between(-0.5f, 0.5f);
  }
  return field;
}

struct Result {
  explicit Result(Extent extent)
      : residual(make_planes<3>(extent)), innovation(extent), expected(extent), variance(extent) {
    variance.fill(0.5f);
  }
  void run(const BasisField& bases, const CoefficientField& coefficients, const Frame& frame) {
    copy_planes(frame.lights[0].radiance, residual);
    for_each_tile(coefficients.grid(), [&](const Rect& tile) {
      predict_tile(bases, coefficients, tile, {residual, innovation, expected, variance});
    });
  }
  Planes<3> residual;
  Plane<float> innovation, expected, variance;
};

// Up to nine products of size 1: a few ulp.
void expect_close(const Result& result, const reference::Prediction& twin, int x, int y) {
  for (std::size_t c = 0; c < 3; ++c) {
    const float residual = result.residual[c](x, y);
    if (std::isfinite(twin.residual[c])) {
      ASSERT_NEAR(residual, twin.residual[c], 5e-6) << x << ", " << y;
    } else {
      ASSERT_FALSE(std::isfinite(residual)) << x << ", " << y;
    }
  }
  ASSERT_EQ(std::isnan(result.innovation(x, y)), std::isnan(twin.innovation)) << x << ", " << y;
  if (!std::isnan(twin.innovation)) {
    ASSERT_NEAR(result.innovation(x, y), twin.innovation, 5e-6) << x << ", " << y;
  }
  ASSERT_NEAR(result.expected(x, y), twin.expected, 5e-6) << x << ", " << y;
  ASSERT_NEAR(result.variance(x, y), 0.5 * twin.variance_factor, 1e-6);
}

EL_KERNEL_TEST(Predict, MatchesTheReference) {
  const FloatTrapsOff nan_is_meant;
  const Frame frame = make_random_frame({.extent = extent}, 2);
  for (const int bases : {1, 3, kMaxBases}) {
    const BasisField field = random_bases(extent, bases, 8);
    const CoefficientField coefficients = random_coefficients(extent, bases);
    std::vector<reference::Prediction> twins;
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        twins.push_back(reference::predict(field, coefficients, frame.lights[0].radiance, x, y));
      }
    }
    on_every_target([&] {
      Result result(extent);
      result.run(field, coefficients, frame);
      auto twin = twins.begin();
      for (int y = 0; y < extent.height; ++y) {
        for (int x = 0; x < extent.width; ++x) expect_close(result, *twin++, x, y);
      }
    });
  }
}

TEST(Predict, PixelsWithoutHistoryKeepTheirLightAsResidual) {
  const Extent extent{5, 3};
  const Frame frame = make_random_frame({.extent = extent, .sky = false}, 2);
  Result result(extent);
  result.innovation.fill(4.0f);
  result.expected.fill(4.0f);
  result.run(BasisField(extent, 3), CoefficientField(extent, 3), frame);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      const float light = frame.lights[0].radiance[1](x, y);
      EXPECT_TRUE(result.residual[1](x, y) == light || std::isnan(light));
      EXPECT_EQ(result.expected(x, y), 0.0f);
      EXPECT_TRUE(std::isnan(result.innovation(x, y)));
    }
  }
}

TEST(Predict, VarianceFollowsGainsBeyondAFactorOfTwo) {
  const Extent extent{5, 3};
  const Frame frame = make_random_frame({.extent = extent, .sky = false}, 2);
  for (const auto& [gain, factor] : {std::pair(0.0f, 0.0f),
                                     {1e-6f, 4e-12f},
                                     {0.25f, 0.25f},
                                     {0.5f, 1.0f},
                                     {2.0f, 1.0f},
                                     {1e6f, 2.5e11f}}) {
    CoefficientField coefficients(extent, 1);
    coefficients.tile(0)[0] = gain - 1.0f;
    for_each_target([&] {
      Result result(extent);
      result.run(BasisField(extent, 1), coefficients, frame);
      EXPECT_NEAR(result.variance(2, 1), 0.5f * factor, 0.1f * factor) << gain;
    });
  }
}

// A gain of 1e30 turns light of 1e-20 into 1e10. At a neighbor with light of 1, the variance would
// overflow.
TEST(Predict, VarianceStaysFiniteForHugeGains) {
  const Extent extent{5, 3};
  const Frame frame = make_random_frame({.extent = extent, .sky = false}, 2);
  CoefficientField coefficients(extent, 1);
  coefficients.tile(0)[0] = 1e30f;
  Result result(extent);
  for_each_target([&] {
    result.variance.fill(0.0f);
    result.variance(1, 1) = 1.0f;
    result.variance(2, 1) = 1e-40f;
    result.run(BasisField(extent, 1), coefficients, frame);
    EXPECT_EQ(result.variance(0, 0), 0.0f);
    EXPECT_FLOAT_EQ(result.variance(1, 1), 1e36f);
    EXPECT_NEAR(result.variance(2, 1), 0.25e20f, 1e16f);
  });
}

}  // namespace
}  // namespace eigenlight
