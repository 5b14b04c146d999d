#include "temporal/bases/update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/reference/update.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

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

  // Pixels with and without history, each with and without a usable sample.
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
    // Unused slots are 0.
    for (int c = 0; c < 3; ++c) {
      for (int k = active; k < field.bases(); ++k) field.value(x, y, c, k) = 0.0f;
    }
  }

  [[nodiscard]] UpdateInputs in() const {
    return {coefficients, learning_rates, residual, &correction, samples,
            old_age,      new_age,        active,   newborn};
  }
  void run() {
    for_each_tile(coefficients.grid(), [&](const Rect& tile) {
      update_tile(in(), tile, {field, estimate});
    });
  }

  BasisField field;
  CoefficientField coefficients, learning_rates;
  Planes<3> residual, correction;
  Plane<float> samples, old_age, new_age;
  int active, newborn = 0;
  Planes<3> estimate;
};

void expect_pixel(const Scene& scene, const reference::Updated& twin, int x, int y) {
  // Products and sums of values of size 1 are exact to a few ulp; the estimate adds eight of them.
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

void expect_agreement(const Scene& before) {
  const Extent extent = before.samples.extent();
  std::vector<reference::Updated> twins;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      twins.push_back(reference::update(before.in(), before.field, {x, y}));
    }
  }
  on_every_target([&] {
    Scene after(extent, before.field.bases(), before.active);
    after.newborn = before.newborn;
    after.run();
    auto twin = twins.begin();
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) expect_pixel(after, *twin++, x, y);
    }
  });
}

EL_KERNEL_TEST(Update, MatchesTheReference) {
  for (const int bases : {1, 3, kMaxBases}) expect_agreement(Scene(extent, bases));
}

EL_KERNEL_TEST(Update, MatchesTheReferenceWithUnusedSlotsAndBirths) {
  Scene scene(extent, 4, 2);
  expect_agreement(scene);
  scene.newborn = 2;
  expect_agreement(scene);
}

// With one basis, steady light and full weights, the update is a running mean.
TEST(Update, SteadyLightGivesTheMeanOfAllFrames) {
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

// Leverage h = c . q of a pixel.
double leverage(const Scene& scene, int x, int y) {
  double h = reference::coefficient_at(scene.learning_rates, x, y, 0);
  for (int k = 1; k < scene.active; ++k) {
    h += reference::coefficient_at(scene.coefficients, x, y, k) *
         reference::coefficient_at(scene.learning_rates, x, y, k);
  }
  return h;
}

TEST(Update, NewPixelsReproduceTheirOwnLight) {
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
        // Exact where c and q are those of one tile; between tiles h can be below 1.
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
