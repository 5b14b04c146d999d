#include "temporal/predict.h"

#include <gtest/gtest.h>

#include "frame/float_traps.h"
#include "tests/reference/predict.h"
#include "tests/support/extents.h"
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
      : prediction(make_planes<3>(extent)), residual(extent), confirmed(extent), age(extent) {}
  void run(const BasisField& bases, const CoefficientField& coefficients, const Frame& frame) {
    for (int i = 0; i < coefficients.grid().count(); ++i) {
      predict_tile(bases, coefficients, frame.indirect, coefficients.grid().tile(i),
                   {prediction, residual, confirmed, age});
    }
  }
  Planes<3> prediction;
  Plane<float> residual, confirmed, age;
};

TEST(Predict, AgreesWithTheTwinOnEveryTarget) {
  const FloatTrapsOff nan_is_meant;
  for (const Extent extent : kSweepExtents) {
    const Frame frame = make_random_frame({.extent = extent}, 2);
    for (const int bases : {1, 3, kMaxBases}) {
      const BasisField field = random_bases(extent, bases, 8);
      const CoefficientField coefficients = random_coefficients(extent, bases);
      for_each_target([&] {
        Result result(extent);
        result.run(field, coefficients, frame);
        for (int y = 0; y < extent.height; ++y) {
          for (int x = 0; x < extent.width; ++x) {
            const auto twin = reference::predict(field, coefficients, frame.indirect, x, y);
            // Up to nine products of size 1: a few ulp.
            for (std::size_t c = 0; c < 3; ++c) {
              ASSERT_NEAR(result.prediction[c](x, y), twin.light[c], 5e-6) << x << ", " << y;
            }
            ASSERT_EQ(result.confirmed(x, y), twin.confirmed ? 1.0f : 0.0f) << x << ", " << y;
            ASSERT_NEAR(result.residual(x, y), twin.residual, 5e-6) << x << ", " << y;
            ASSERT_EQ(result.age(x, y), field.age(x, y));
          }
        }
      });
    }
  }
}

TEST(Predict, WithoutHistoryIsZeroAndUnconfirmed) {
  const Extent extent{5, 3};
  const Frame frame = make_random_frame({.extent = extent, .sky = false}, 2);
  Result result(extent);
  result.prediction[1].fill(4.0f);
  result.residual.fill(4.0f);
  result.run(BasisField(extent, 3), CoefficientField(extent, 3), frame);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(result.prediction[1](x, y), 0.0f);
      EXPECT_EQ(result.residual(x, y), 0.0f);
      EXPECT_EQ(result.confirmed(x, y), 0.0f);
      EXPECT_EQ(result.age(x, y), 0.0f);
    }
  }
}

}  // namespace
}  // namespace eigenlight
