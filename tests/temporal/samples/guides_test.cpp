#include "temporal/samples/guides.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "tests/support/extents.h"
#include "tests/support/targets.h"

namespace eigenlight {
namespace {

// Every kind of depth and normal beside each other.
GBuffer nonsense(Extent extent) {
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

TEST(Guides, CountAsTheSlowTestDoes) {
  for_each_target([] {
    for (const Extent extent : kSweepExtents) {
      const GBuffer surface = nonsense(extent);
      for (int y = 0; y < extent.height; ++y) {
        PixelCounts expected;
        for (int x = 0; x < extent.width; ++x) {
          const bool shown = surface.id(x, y) != 0;
          expected.surface += shown ? 1 : 0;
          expected.unguided += shown && !has_usable_guides(surface, x, y) ? 1 : 0;
        }
        const PixelCounts found = count_guides(surface, {0, y, extent.width, y + 1});
        ASSERT_EQ(found.surface, expected.surface) << y;
        ASSERT_EQ(found.unguided, expected.unguided) << y;
      }
    }
  });
}

}  // namespace
}  // namespace eigenlight
