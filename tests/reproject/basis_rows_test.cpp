#include "reproject/basis_rows.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/compare.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

void expect_loaded(const BasisField& field, const Tile& row, const BasisRows& rows) {
  for (int x = row.x0; x < row.x1; ++x) {
    const int i = x - row.x0;
    ASSERT_EQ(rows.age[i], field.age(x, row.y0));
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < field.bases(); ++k) {
        ASSERT_EQ(rows.values[c * field.bases() + k][i], field.value(x, row.y0, c, k))
            << "x " << x << " channel " << c << " k " << k;
      }
    }
  }
  constexpr int kVector = static_cast<int>(Plane<float>::kLine / sizeof(float));
  for (int i = row.x1 - row.x0; i % kVector != 0; ++i) {
    ASSERT_EQ(rows.age[i], 0.0f);
    for (int j = 0; j < 3 * field.bases(); ++j) ASSERT_EQ(rows.values[j][i], 0.0f);
  }
}

TEST(BasisRows, LoadAndStoreRoundTripForEveryNumberOfBasesOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    for (int bases = 1; bases <= kMaxBases; ++bases) {
      const BasisField field = random_bases(extent, bases, 11);
      for_each_target([&] {
        BasisField copy(extent, bases);
        copy.data().fill(9.0f);
        const auto rows = std::make_unique<BasisRows>();
        for (int y = 0; y < extent.height; ++y) {
          for (int x0 = 0; x0 < extent.width; x0 += kSegment) {
            const Tile row{x0, y, std::min(x0 + kSegment, extent.width), y + 1, 0};
            load_rows(field, row, *rows);
            if (y == 0) expect_loaded(field, row, *rows);
            store_rows(*rows, row, copy);
          }
        }
        // Zeros in the padding of each pixel included.
        EXPECT_TRUE(planes_equal(copy.data(), field.data())) << bases << " bases";
      });
    }
  }
}

TEST(BasisRows, StoreLeavesTheNeighborsAlone) {
  for (int width = 1; width <= 9; ++width) {
    const BasisField field = random_bases({20, 1}, 2, 11);
    for_each_target([&] {
      BasisField copy({20, 1}, 2);
      copy.data().fill(9.0f);
      const auto rows = std::make_unique<BasisRows>();
      load_rows(field, {4, 0, 4 + width, 1, 0}, *rows);
      store_rows(*rows, {4, 0, 4 + width, 1, 0}, copy);
      EXPECT_EQ(copy.age(3, 0), 9.0f);
      EXPECT_EQ(copy.age(4, 0), field.age(4, 0));
      EXPECT_EQ(copy.age(3 + width, 0), field.age(3 + width, 0));
      EXPECT_EQ(copy.value(4 + width, 0, 0, 0), 9.0f);
    });
  }
}

TEST(BasisField, RefusesTooFewOrTooManyBases) {
  EXPECT_THROW(BasisField({4, 4}, 0), std::invalid_argument);
  EXPECT_THROW(BasisField({4, 4}, kMaxBases + 1), std::invalid_argument);
  EXPECT_THROW(BasisField({0, 4}, 3), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
