// Interpolation of coefficients between tiles.
#include <gtest/gtest.h>

#include <cmath>

#include "temporal/bases/coefficients.h"
#include "tests/reference/coefficients.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

EL_KERNEL_TEST(CoefficientField, InterpolationMatchesTheReference) {
  CoefficientField field(extent, 2);
  for (int i = 0; i < field.grid().count(); ++i) {
    PixelRandom random(3, i, 0);
    for (float& delta : field.tile(i)) delta = random.between(-1.0f, 1.0f);
  }
  const TileGrid rows(extent, kCoefficientTile, 1);
  on_every_target([&] {
    PerTile<CoefficientRows> found(rows);
    for_each_tile(rows, [&](const Tile& row) { field.rows(row, 2, found[row]); });
    for (int i = 0; i < rows.count(); ++i) {
      const Rect row = rows.tile(i);
      for (int x = row.x0; x < row.x1; ++x) {
        for (int k = 0; k < 2; ++k) {
          ASSERT_NEAR(found[i][k][x - row.x0], reference::coefficient_at(field, x, row.y0, k), 2e-6)
              << x << ", " << row.y0;
        }
      }
    }
  });
}

TEST(CoefficientField, InterpolationIsContinuousBetweenTiles) {
  CoefficientField field({191, 107}, 1);
  for (int i = 0; i < field.grid().count(); ++i) field.tile(i)[0] = i % 2 == 0 ? 1.0f : -1.0f;
  const auto value = [&](int x, int y) {
    CoefficientRows out;
    const int first = x / kCoefficientTile * kCoefficientTile;
    field.rows({first, y, x + 1, y + 1}, 1, out);
    return out[0][x - first];
  };
  // Neighboring tile centers are 32 pixels apart and differ by 2, so the slope is at most 2/32 per
  // pixel along rows and columns.
  constexpr float kSlope = 2.0f / kCoefficientTile + 1e-5f;
  for (int y = 0; y + 1 < 107; ++y) {
    for (int x = 0; x + 1 < 191; ++x) {
      ASSERT_LE(std::abs(value(x + 1, y) - value(x, y)), kSlope) << x << ", " << y;
      ASSERT_LE(std::abs(value(x, y + 1) - value(x, y)), kSlope) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace eigenlight
