#include "frame/plane.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/extents.h"

namespace eigenlight {
namespace {

template <typename T>
void expect_rows_on_lines(Extent extent, int channels) {
  const Plane<T> plane(extent, channels);
  EXPECT_EQ(plane.extent(), extent);
  EXPECT_GE(plane.stride(), static_cast<std::size_t>(extent.width * channels));
  for (int y = 0; y < extent.height; ++y) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(plane.row(y)) % Plane<T>::kLine, 0u);
  }
  for (const T value : plane.storage()) EXPECT_EQ(value, T{});
}

TEST(Plane, RowsStartOnACacheLineAndAreZero) {
  for (const Extent extent : kSweepExtents) {
    expect_rows_on_lines<float>(extent, 1);
    expect_rows_on_lines<float>(extent, 28);
    expect_rows_on_lines<std::uint8_t>(extent, 1);
    expect_rows_on_lines<double>(extent, 3);
  }
}

TEST(Plane, RowsArePaddedToWholeCacheLines) {
  EXPECT_EQ(Plane<float>({1, 2}).stride(), 16u);
  EXPECT_EQ(Plane<float>({16, 2}).stride(), 16u);
  EXPECT_EQ(Plane<float>({17, 2}).stride(), 32u);
  EXPECT_EQ(Plane<std::uint8_t>({65, 1}).stride(), 128u);
  EXPECT_EQ(Plane<float>({5, 3}, 4).stride(), 32u);
  EXPECT_EQ(Plane<float>({5, 3}, 4).storage().size(), 96u);
}

TEST(Plane, RowsAndPlanesAvoidCacheConflicts) {
  const Plane<float> first({1024, 8}), second({1024, 8});
  EXPECT_EQ(first.stride(), 1024u + 16u);
  const auto place = [](const float* p) { return reinterpret_cast<std::uintptr_t>(p) % 4096; };
  EXPECT_NE(place(first.row(0)), place(first.row(4)));
  EXPECT_NE(place(first.row(0)), place(second.row(0)));
}

TEST(Plane, PixelsAreAddressedByColumnRowAndChannel) {
  Plane<float> plane({5, 3}, 2);
  plane.at(4, 2)[1] = 7.0f;
  plane(0, 1) = 3.0f;
  EXPECT_EQ(plane.row(2)[9], 7.0f);
  EXPECT_EQ(plane.row(1)[0], 3.0f);
  EXPECT_EQ(plane(4, 2), 0.0f);
}

TEST(Plane, CloneHasItsOwnStorage) {
  Plane<int> plane({5, 3});
  plane(2, 1) = 4;
  const Plane<int> copy = plane.clone();
  plane(2, 1) = 5;
  EXPECT_EQ(copy(2, 1), 4);
  EXPECT_EQ(copy.extent(), plane.extent());
  EXPECT_TRUE(Plane<int>().clone().empty());
}

TEST(Plane, CopyRejectsAnotherShape) {
  Plane<float> plane({5, 3}, 2), same({5, 3}, 2);
  same.at(4, 2)[1] = 2.0f;
  const float* storage = plane.row(0);
  plane.copy_from(same);
  EXPECT_EQ(plane.at(4, 2)[1], 2.0f);
  EXPECT_EQ(plane.row(0), storage);
  EXPECT_THROW(plane.copy_from(Plane<float>({3, 5}, 2)), std::invalid_argument);
  EXPECT_THROW(plane.copy_from(Plane<float>({5, 3}, 1)), std::invalid_argument);
  EXPECT_THROW(plane.copy_from(Plane<float>()), std::invalid_argument);
}

TEST(Plane, ReshapeAllocatesOnlyBeyondTheLargestSizeSoFar) {
  Plane<float> plane({65, 17}, 16);
  const float* first = plane.row(0);
  for (const int channels : {4, 13, 16}) {
    plane.fill(3.0f);
    plane.reshape(channels);
    EXPECT_EQ(plane.row(0), first);
    EXPECT_EQ(plane.channels(), channels);
    EXPECT_EQ(plane.stride(), Plane<float>({65, 17}, channels).stride());
    for (const float value : plane.storage()) ASSERT_EQ(value, 0.0f);
  }
  plane.reshape(20);
  EXPECT_LE(plane.at(64, 16) + 20, plane.storage().data() + plane.storage().size());
  EXPECT_THROW(plane.reshape(0), std::invalid_argument);
  EXPECT_THROW(plane.reshape(65), std::invalid_argument);
}

TEST(Plane, RejectsInvalidSizes) {
  EXPECT_THROW(Plane<float>({0, 0}), std::invalid_argument);
  EXPECT_THROW(Plane<float>({-1, 4}), std::invalid_argument);
  EXPECT_THROW(Plane<float>({4, kMaxSide + 1}), std::invalid_argument);
  EXPECT_THROW(Plane<float>({4, 4}, 0), std::invalid_argument);
  EXPECT_THROW(Plane<float>({4, 4}, 65), std::invalid_argument);
}

TEST(Plane, EnsureExtentReplacesPlanesOfAnotherSize) {
  Plane<float> plane({5, 3});
  plane(1, 1) = 6.0f;
  ensure_extent(plane, {5, 3});
  EXPECT_EQ(plane(1, 1), 6.0f);
  ensure_extent(plane, {3, 5});
  EXPECT_EQ(plane.extent(), (Extent{3, 5}));
  EXPECT_EQ(plane(1, 1), 0.0f);
}

// Values 0, 1, 2, ... in rows that are `stride` floats apart, the first of them `offset` floats in.
struct Foreign {
  Foreign(Extent size, int row, int offset)
      : extent(size), stride(row), memory(static_cast<std::size_t>(row * size.height + offset)) {
    first = memory.data() + offset;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) first[y * row + x] = value(x, y);
    }
  }
  [[nodiscard]] float value(int x, int y) const { return static_cast<float>(y * extent.width + x); }
  [[nodiscard]] std::ptrdiff_t row_bytes() const {
    return stride * static_cast<std::ptrdiff_t>(sizeof(float));
  }

  Extent extent;
  int stride;
  std::vector<float> memory;
  float* first;
};

TEST(PlaneView, ShowsForeignMemory) {
  for (const Extent extent : {Extent{65, 7}, Extent{48, 1}, Extent{64, 2}, Extent{3, 5}}) {
    const Foreign foreign(extent, extent.width + 3, 1);
    const auto view = Plane<float>::view(foreign.first, extent, foreign.row_bytes());
    ASSERT_EQ(view.extent(), extent);
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) ASSERT_EQ(view(x, y), foreign.value(x, y));
    }
  }
}

TEST(PlaneView, CopiesOnlyTheFirstAndTheLastRow) {
  const Foreign foreign({65, 7}, 70, 1);
  const auto view = Plane<float>::view(foreign.first, foreign.extent, foreign.row_bytes());
  EXPECT_TRUE(view.is_view());
  for (int y = 0; y < 7; ++y) EXPECT_EQ(view.row(y) == foreign.first + 70 * y, y > 0 && y < 6) << y;
  const Plane<float> copy = view.clone();
  EXPECT_FALSE(copy.is_view());
  for (int y = 0; y < 7; ++y) EXPECT_EQ(copy(64, y), foreign.value(64, y));
}

TEST(PlaneView, ReadsImagesFromTheBottomUp) {
  const Foreign foreign({65, 7}, 66, 0);
  const auto view =
      Plane<float>::view(foreign.first + 6 * 66, foreign.extent, -foreign.row_bytes());
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 65; ++x) ASSERT_EQ(view(x, y), foreign.value(x, 6 - y));
  }
}

TEST(PlaneView, RefusesStridesThatNoImageHas) {
  const Foreign foreign({65, 7}, 70, 0);
  const auto view = [&](const float* first, std::ptrdiff_t row_bytes) {
    return Plane<float>::view(first, {65, 7}, row_bytes);
  };
  EXPECT_THROW((void)view(nullptr, 280), std::invalid_argument);
  EXPECT_THROW((void)view(foreign.first, 256), std::invalid_argument);
  EXPECT_THROW((void)view(foreign.first, 0), std::invalid_argument);
  EXPECT_THROW((void)view(foreign.first, 281), std::invalid_argument);
  EXPECT_THROW((void)Plane<float>::view(foreign.first, {0, 7}, 280), std::invalid_argument);
}

TEST(Extent, ContainsItsPixelsOnly) {
  constexpr Extent kExtent{5, 3};
  EXPECT_EQ(kExtent.pixels(), 15u);
  EXPECT_TRUE(kExtent.contains(4, 2));
  EXPECT_FALSE(kExtent.contains(5, 2));
  EXPECT_FALSE(kExtent.contains(4, 3));
  EXPECT_FALSE(kExtent.contains(-1, 0));
  EXPECT_FALSE(kExtent.contains(0, -1));
}

}  // namespace
}  // namespace eigenlight
