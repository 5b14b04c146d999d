#include "reproject/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reference/warp.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

// Where the upper left tap of pixel x of a row lies.
using Place = std::function<glm::ivec2(int x)>;

// Taps of random weights. One pixel in five has none, and taps beside the image have weight 0.
TapSegment make_taps(Extent extent, const Rect& row, std::uint32_t seed, const Place& place) {
  TapSegment taps{};
  for (int x = row.x0; x < row.x1; ++x) {
    PixelRandom random(seed, x, row.y0);
    const int i = x - row.x0;
    const glm::ivec2 first = place(x);
    taps.x[i] = std::clamp(first.x, -1, extent.width - 1);
    taps.y[i] = std::clamp(first.y, -1, extent.height - 1);
    if (random.uniform() < 0.2f) continue;
    for (int t = 0; t < 4; ++t) {
      const glm::ivec2 tap = taps.tap(t, i);
      const bool inside = extent.contains(tap.x, tap.y);
      taps.weight[t][i] = inside ? random.between(0.1f, 0.3f) : 0.0f;
    }
  }
  return taps;
}

Place anywhere(Extent extent, std::uint32_t seed) {
  return [=](int x) {
    PixelRandom random(seed, x, 1);
    return glm::ivec2(random.between(-1.0f, static_cast<float>(extent.width)),
                      random.between(-1.0f, static_cast<float>(extent.height)));
  };
}

BasisField warped(const BasisField& from, const TapSegment& taps, const Rect& row) {
  BasisField to(from.extent(), from.bases());
  fill_bases(to, 5.0f);
  warp_bases(from, taps, row, to);
  return to;
}

void expect_warp(const BasisField& from, const TapSegment& taps, const Rect& row) {
  const BasisField to = warped(from, taps, row);
  for (int x = row.x0; x < row.x1; ++x) {
    const int i = x - row.x0;
    const double age = reference::warped(taps, i, [&](int tx, int ty) { return from.age(tx, ty); });
    ASSERT_NEAR(to.age(x, row.y0), age, 1e-5 * 40.0);
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < from.bases(); ++k) {
        const double wanted =
            reference::warped(taps, i, [&](int tx, int ty) { return from.value(tx, ty, c, k); });
        // Four products of values below 1.5: a few ulp.
        ASSERT_NEAR(to.value(x, row.y0, c, k), wanted, 1e-6) << x << " channel " << c << " k " << k;
      }
    }
  }
}

void expect_plane_warp(const Plane<float>& from, const TapSegment& taps, const Rect& row) {
  Plane<float> to(from.extent());
  to.fill(5.0f);
  warp_plane(from, taps, row, to);
  for (int x = row.x0; x < row.x1; ++x) {
    const int i = x - row.x0;
    ASSERT_NEAR(to(x, row.y0), reference::warped(taps, i, from), 1e-6) << x << ", " << row.y0;
  }
}

// All segments of the first, a middle and the last row.
void for_each_row(Extent extent, const std::function<void(const Tile&)>& visit) {
  for (const int y : {0, extent.height / 2, extent.height - 1}) {
    for (int x0 = 0; x0 < extent.width; x0 += kSegment) {
      visit({x0, y, std::min(x0 + kSegment, extent.width), y + 1});
    }
  }
}

EL_KERNEL_TEST(Warp, MatchesTheReferenceForAnyNumberOfBases) {
  for (int bases = 1; bases <= kMaxBases; ++bases) {
    const BasisField from = random_bases(extent, bases, 7);
    on_every_target([&] {
      for_each_row(extent, [&](const Rect& row) {
        expect_warp(from, make_taps(extent, row, 3, anywhere(extent, 4)), row);
      });
    });
  }
}

// All pixels move alike, except that one pixel, or all pixels from one on, lie a pixel further
// left.
EL_KERNEL_TEST(Warp, MatchesTheReferenceForCoherentMotion) {
  const BasisField from = random_bases(extent, 2, 7);
  const Plane<float> plane = random_plane(extent, 9, 0.5f, 2.0f);
  on_every_target([&] {
    for (int n = 0; n < 25 * 5; ++n) {
      const glm::ivec2 shift{n % 5 - 2, n / 5 % 5 - 2};
      const int odd = std::array{-1, 0, 1, 7, 16}[static_cast<std::size_t>(n / 25)];
      for_each_row(extent, [&](const Rect& row) {
        const TapSegment taps = make_taps(extent, row, 5, [&](int x) {
          const int i = x - row.x0;
          const bool apart = n % 2 == 0 ? i == odd : i >= odd && odd >= 0;
          return glm::ivec2(x + shift.x - (apart ? 1 : 0), row.y0 + shift.y);
        });
        expect_warp(from, taps, row);
        expect_plane_warp(plane, taps, row);
      });
    }
  });
}

TEST(Warp, WritesOnlyItsRowAndZerosItsPadding) {
  const Extent extent{65, 17};
  const BasisField from = random_bases(extent, 3, 7);
  const Rect row{64, 4, 65, 5};
  const TapSegment taps = make_taps(extent, row, 3, anywhere(extent, 4));
  for_each_target([&] {
    const BasisField to = warped(from, taps, row);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        if (y == 4 && x == 64) continue;
        ASSERT_EQ(to.value(x, y, 1, 1), 5.0f) << x << ", " << y;
      }
      for (int line = 0; line < to.lines(); ++line) {
        const float* block = to.at(64, y) + kBlock * line;
        for (int i = 1; i < kBlock; ++i) ASSERT_EQ(block[i], 0.0f) << y << " line " << line;
      }
    }
  });
}

// NaN lies where taps of weight 0 would read.
TEST(Warp, IgnoresTapsOfZeroWeight) {
  const Extent extent{65, 17};
  Plane<float> from = random_plane(extent, 9, 0.5f, 2.0f);
  const Rect row{0, 4, 64, 5};
  TapSegment taps = make_taps(extent, row, 3, [](int x) { return glm::ivec2(x - 1, 6); });
  BasisField bases = random_bases(extent, 2, 7);
  for (int x = 0; x < extent.width; x += 3) {
    from(x, 7) = bases.value(x, 7, 2, 1) = std::numeric_limits<float>::quiet_NaN();
  }
  // Tap 2 of pixel x is (x - 1, 7), tap 3 (x, 7).
  for (std::size_t i = 0; i < kSegment; ++i) {
    if (i % 3 == 1) taps.weight[2][i] = 0.0f;
    if (i % 3 == 0) taps.weight[3][i] = 0.0f;
  }
  for_each_target([&] {
    Plane<float> to(extent);
    warp_plane(from, taps, row, to);
    const BasisField to_bases = warped(bases, taps, row);
    for (int x = row.x0; x < row.x1; ++x) {
      EXPECT_TRUE(std::isfinite(to(x, 4)) && std::isfinite(to_bases.value(x, 4, 2, 1))) << x;
    }
  });
}

TEST(BasisField, AssignCopiesTheBasesThatBothHave) {
  const BasisField from = random_bases({65, 17}, 3, 7);
  for (const int bases : {2, 5}) {
    BasisField to({65, 17}, bases);
    fill_bases(to, 4.0f);
    to.assign(from);
    for (int k = 0; k < bases; ++k) {
      EXPECT_EQ(to.value(64, 16, 2, k), k < 3 ? from.value(64, 16, 2, k) : 0.0f);
    }
    EXPECT_EQ(to.age(64, 16), from.age(64, 16));
    to.clear_basis(1);
    EXPECT_EQ(to.value(64, 16, 2, 1), 0.0f);
    EXPECT_EQ(to.value(64, 16, 2, 0), from.value(64, 16, 2, 0));
  }
  EXPECT_THROW(BasisField({64, 17}, 3).assign(from), std::invalid_argument);
}

TEST(BasisField, ClearErasesATile) {
  BasisField field({65, 17}, 2);
  fill_bases(field, 4.0f);
  field.clear({64, 3, 65, 5});
  EXPECT_EQ(field.value(64, 4, 2, 1), 0.0f);
  EXPECT_EQ(field.age(64, 3), 0.0f);
  EXPECT_EQ(field.age(63, 3), 4.0f);
  EXPECT_EQ(field.age(64, 5), 4.0f);
}

TEST(BasisField, RejectsInvalidNumbersOfBases) {
  EXPECT_THROW(BasisField({4, 4}, 0), std::invalid_argument);
  EXPECT_THROW(BasisField({4, 4}, kMaxBases + 1), std::invalid_argument);
  EXPECT_THROW(BasisField({0, 4}, 3), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
