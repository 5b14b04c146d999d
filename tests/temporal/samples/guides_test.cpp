#include "temporal/samples/guides.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/support/kernel_test.h"

namespace eigenlight {
namespace {

// Valid and invalid depths and normals side by side.
GBuffer mixed_surface(Extent extent) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr std::array kDepths{1.0f, 0.0f, -1.0f, 1e-20f, 1e20f, kInf, kNaN, 5.0f, 2.0f};
  constexpr std::array kNormals{1.0f, 0.99f, 0.9f, 1.02f, 0.0f, 1e30f, kNaN, -kInf};
  GBuffer surface;
  surface.resize(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const auto i = static_cast<std::size_t>(x + 3 * y);
      surface.id(x, y) = i % 5 == 4 ? 0 : 7;
      surface.depth(x, y) = kDepths[i % 3 == 0 ? i % kDepths.size() : 0];
      surface.normal[i % 3](x, y) = kNormals[i % 2 == 0 ? i / 2 % kNormals.size() : 0];
    }
  }
  return surface;
}

EL_KERNEL_TEST(Guides, CountsMatchTheScalarTest) {
  const GBuffer surface = mixed_surface(extent);
  on_every_target([&] {
    for_each_tile(TileGrid(extent, extent.width, 1), [&](const Rect& row) {
      PixelCounts expected;
      for (int x = 0; x < extent.width; ++x) {
        const bool shown = surface.id(x, row.y0) != 0;
        expected.surface += shown ? 1 : 0;
        expected.unguided += shown && !has_usable_guides(surface, x, row.y0) ? 1 : 0;
      }
      const PixelCounts found = count_guides(surface, row);
      EXPECT_EQ(found.surface, expected.surface) << row.y0;
      EXPECT_EQ(found.unguided, expected.unguided) << row.y0;
    });
  });
}

}  // namespace
}  // namespace eigenlight
