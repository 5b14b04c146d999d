#include "temporal/bases/update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reference/update.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

struct Scene {
  Scene(Extent extent, int bases, int used = 0)
      : field(random_bases(extent, bases, 8)),
        coefficients(extent, bases),
        learning_rates(extent, bases),
        residual(make_planes<3>(extent)),
        correction(make_planes<3>(extent)),
        samples(extent),
        old_age(extent),
        new_age(extent),
        active(used > 0 ? used : bases),
        estimate(make_planes<3>(extent)) {
    for (int i = 0; i < coefficients.grid().count(); ++i) {
      PixelRandom random(3, i, 0);
      for (float& delta : coefficients.tile(i)) delta = random.between(-0.5f, 0.5f);
      for (float& q : learning_rates.tile(i)) q = random.between(-0.8f, 0.8f);
    }
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) fill(x, y);
    }
  }

  // With and without history, each with and without a usable sample.
  void fill(int x, int y) {
    PixelRandom random(6, x, y);
    const bool usable = random.uniform() < 0.9f;
    samples(x, y) = usable ? random.between(1.0f, 3.0f) : 0.0f;
    old_age(x, y) = field.age(x, y);
    new_age(x, y) = old_age(x, y) + samples(x, y);
    const bool known = old_age(x, y) > 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      const float prediction = known ? random.between(0.0f, 2.0f) : 0.0f;
      correction[c](x, y) = known && usable ? random.between(-0.2f, 0.2f) : 0.0f;
      residual[c](x, y) = usable ? random.between(0.0f, 2.0f) - prediction
                                 : std::numeric_limits<float>::quiet_NaN();
    }
    // Slots out of use hold nothing.
    for (int c = 0; c < 3; ++c) {
      for (int k = active; k < field.bases(); ++k) field.value(x, y, c, k) = 0.0f;
    }
  }

  [[nodiscard]] UpdateInputs in() const {
    return {coefficients, learning_rates, residual, &correction, samples,
            old_age,      new_age,        active,   newborn};
  }
  void run() {
    for (int i = 0; i < coefficients.grid().count(); ++i) {
      update_tile(in(), coefficients.grid().tile(i), {field, estimate});
    }
  }

  BasisField field;
  CoefficientField coefficients, learning_rates;
  Planes<3> residual, correction;
  Plane<float> samples, old_age, new_age;
  int active, newborn = 0;
  Planes<3> estimate;
};

void expect_pixel(const Scene& scene, const reference::Updated& twin, int x, int y) {
  // Products and sums of values of size 1: a few ulp; eight of them in the estimate.
  ASSERT_NEAR(scene.field.age(x, y), twin.age, 1e-6 * twin.age);
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    ASSERT_NEAR(scene.estimate[channel](x, y), twin.estimate[channel], 1e-5) << x << ", " << y;
    for (int k = 0; k < scene.field.bases(); ++k) {
      ASSERT_NEAR(scene.field.value(x, y, c, k), twin.basis[channel][static_cast<std::size_t>(k)],
                  5e-6)
          << x << ", " << y << " channel " << c << " k " << k;
    }
  }
}

void expect_agreement(Scene before) {
  const Extent extent = before.samples.extent();
  for_each_target([&] {
    Scene after(extent, before.field.bases(), before.active);
    after.newborn = before.newborn;
    after.run();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        expect_pixel(after, reference::update(before.in(), before.field, {x, y}), x, y);
      }
    }
  });
}

TEST(Update, AgreesWithTheTwinOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    for (const int bases : {1, 3, kMaxBases}) expect_agreement(Scene(extent, bases));
  }
}

TEST(Update, OfSlotsInUseAndBirthsAgreesWithTheTwin) {
  expect_agreement(Scene({65, 17}, 4, 2));
  Scene birth({65, 17}, 4, 2);
  birth.newborn = 2;
  expect_agreement(std::move(birth));
}

// With one basis, steady light and full weights this is the running mean.
TEST(Update, OfSteadyLightIsTheMeanOfAllFrames) {
  const Extent extent{5, 3};
  Scene scene(extent, 1);
  scene.field = BasisField(extent, 1);
  for (int i = 0; i < scene.coefficients.grid().count(); ++i) {
    scene.coefficients.tile(i)[0] = scene.learning_rates.tile(i)[0] = 0.0f;
  }
  double sum = 0.0;
  for (int n = 1; n <= 50; ++n) {
    const float u = PixelRandom(9, n, 0).between(0.0f, 2.0f);
    sum += u;
    scene.samples.fill(1.0f);
    scene.old_age.fill(static_cast<float>(n - 1));
    scene.new_age.fill(static_cast<float>(n));
    for (std::size_t c = 0; c < 3; ++c) {
      scene.correction[c].fill(0.0f);
      scene.residual[c].fill(u - scene.field.value(2, 1, static_cast<int>(c), 0));
    }
    scene.run();
    EXPECT_NEAR(scene.estimate[1](2, 1), sum / n, 1e-5) << n;
    EXPECT_EQ(scene.field.age(4, 2), static_cast<float>(n));
  }
}

// h = c . q of a pixel.
double leverage(const Scene& scene, int x, int y) {
  double h = reference::coefficient_at(scene.learning_rates, x, y, 0);
  for (int k = 1; k < scene.active; ++k) {
    h += reference::coefficient_at(scene.coefficients, x, y, k) *
         reference::coefficient_at(scene.learning_rates, x, y, k);
  }
  return h;
}

TEST(Update, NewPixelsExplainTheirOwnLight) {
  Scene scene({65, 17}, 3);
  const Scene before({65, 17}, 3);
  scene.run();
  int fresh = 0, empty = 0;
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 65; ++x) {
      if (before.old_age(x, y) > 0.0f) continue;
      const bool usable = before.samples(x, y) > 0.0f;
      ++(usable ? fresh : empty);
      for (std::size_t c = 0; c < 3; ++c) {
        // Exactly where c and q belong together; interpolated ones may give up to h < 1 less.
        const double h = leverage(before, x, y);
        const float wanted = usable ? before.residual[c](x, y) : 0.0f;
        EXPECT_NEAR(scene.estimate[c](x, y), wanted * std::min(h, 1.0), 1e-5);
      }
      EXPECT_EQ(scene.field.age(x, y), usable ? before.samples(x, y) : 0.0f);
    }
  }
  EXPECT_GT(fresh, 20);
  EXPECT_GT(empty, 2);
}

}  // namespace
}  // namespace eigenlight
