#include "reproject/warp.h"

#include <gtest/gtest.h>

#include "tests/reference/warp.h"
#include "tests/support/extents.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

TapSegment random_taps(Extent extent, std::uint32_t seed) {
  TapSegment taps{};
  for (int i = 0; i < kSegment; ++i) {
    PixelRandom random(seed, i, 0);
    const auto at = static_cast<std::size_t>(i);
    const bool known = random.uniform() > 0.2f;
    float left = 1.0f;
    for (std::size_t t = 0; t < 4; ++t) {
      const float share = t == 3 ? left : left * random.uniform();
      left -= share;
      taps.weight[t][at] = known ? share : 0.0f;
      taps.x[t][at] = static_cast<int>(random.uniform() * static_cast<float>(extent.width));
      taps.y[t][at] = static_cast<int>(random.uniform() * static_cast<float>(extent.height));
    }
  }
  return taps;
}

void expect_warp(const BasisField& from, const TapSegment& taps, const Tile& row) {
  BasisField to(from.extent(), from.bases());
  warp_bases(from, taps, row, to);
  for (int x = row.x0; x < row.x1; ++x) {
    const auto i = static_cast<std::size_t>(x - row.x0);
    const double age = reference::warped(taps, i, [&](int tx, int ty) { return from.age(tx, ty); });
    EXPECT_NEAR(to.age(x, row.y0), age, 1e-5 * 40.0);
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < from.bases(); ++k) {
        const double wanted =
            reference::warped(taps, i, [&](int tx, int ty) { return from.value(tx, ty, c, k); });
        // Four products of values below 1.5: a few ulp.
        EXPECT_NEAR(to.value(x, row.y0, c, k), wanted, 1e-6) << x << " channel " << c << " k " << k;
      }
    }
    for (int j = 3 * from.bases() + 1; j < from.pixel_floats(); ++j) {
      EXPECT_EQ(to.pixel(x, row.y0)[j], 0.0f) << "padding";
    }
  }
}

TEST(WarpBases, AgreesWithTheTwinForEveryNumberOfBasesOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    for (int bases = 1; bases <= kMaxBases; ++bases) {
      const BasisField from = random_bases(extent, bases, 7);
      const TapSegment taps = random_taps(extent, 3);
      const Tile row{0, extent.height / 2, std::min(extent.width, kSegment), extent.height / 2 + 1,
                     0};
      for_each_target([&] { expect_warp(from, taps, row); });
    }
  }
}

TEST(WarpBases, WritesOnlyTheRowItIsGiven) {
  const Extent extent{65, 17};
  const BasisField from = random_bases(extent, 3, 7);
  BasisField to(extent, 3);
  to.data().fill(5.0f);
  warp_bases(from, random_taps(extent, 3), {32, 4, 64, 5, 0}, to);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      if (y == 4 && x >= 32 && x < 64) continue;
      ASSERT_EQ(to.value(x, y, 1, 1), 5.0f) << x << ", " << y;
    }
  }
}

TEST(WarpPlane, AgreesWithTheTwinAndIsZeroWithoutTaps) {
  for (const Extent extent : kSweepExtents) {
    const Plane<float> from = random_plane(extent, 9, 0.5f, 2.0f);
    const TapSegment taps = random_taps(extent, 5);
    const Tile row{0, extent.height - 1, std::min(extent.width, kSegment), extent.height, 0};
    Plane<float> to(extent);
    warp_plane(from, taps, row, to);
    for (int x = row.x0; x < row.x1; ++x) {
      const auto i = static_cast<std::size_t>(x);
      EXPECT_NEAR(to(x, row.y0), reference::warped(taps, i, from), 1e-6);
      const float sum = taps.weight[0][i] + taps.weight[1][i] + taps.weight[2][i];
      const bool none = sum == 0.0f && taps.weight[3][i] == 0.0f;
      EXPECT_EQ(to(x, row.y0) == 0.0f, none);
    }
  }
}

// Taps of neighbors that moved alike, but for one that is a pixel farther to the left; moved to the
// image's edge where they lie beside it.
TapSegment shifted_taps(Extent extent, const Tile& row, glm::ivec2 shift, int straggler) {
  TapSegment taps = random_taps(extent, 5);
  for (int i = 0; i < kSegment; ++i) {
    const int left = row.x0 + i + shift.x - (i == straggler ? 1 : 0);
    for (int t = 0; t < 4; ++t) {
      const auto at = static_cast<std::size_t>(t), lane = static_cast<std::size_t>(i);
      taps.x[at][lane] = std::clamp(left + t % 2, 0, extent.width - 1);
      taps.y[at][lane] = std::clamp(row.y0 + shift.y + t / 2, 0, extent.height - 1);
    }
  }
  return taps;
}

void expect_plane_warp(const Plane<float>& from, const TapSegment& taps, const Tile& row) {
  Plane<float> to(from.extent());
  warp_plane(from, taps, row, to);
  for (int x = row.x0; x < row.x1; ++x) {
    const auto i = static_cast<std::size_t>(x - row.x0);
    ASSERT_NEAR(to(x, row.y0), reference::warped(taps, i, from), 1e-6) << x << ", " << row.y0;
  }
}

TEST(WarpPlane, AgreesWithTheTwinWhereNeighborsMoveAlikeOnEveryTarget) {
  for (const Extent extent : kSweepExtents) {
    const Plane<float> from = random_plane(extent, 9, 0.5f, 2.0f);
    for (int n = 0; n < 25 * 5; ++n) {
      const int x0 = extent.width > kSegment && n % 2 == 0 ? kSegment : 0;
      const int y = n % 3 == 0 ? extent.height - 1 : 0;
      const Tile row{x0, y, std::min(extent.width, x0 + kSegment), y + 1, 0};
      const int stragglers[] = {-1, 0, 1, 7, 16};
      const TapSegment taps =
          shifted_taps(extent, row, {n % 5 - 2, n / 5 % 5 - 2}, stragglers[n / 25]);
      for_each_target([&] { expect_plane_warp(from, taps, row); });
    }
  }
}

}  // namespace
}  // namespace eigenlight
