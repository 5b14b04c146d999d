// The guided filter against its slow reference, by tiles, strips and threads.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "frame/float_traps.h"
#include "spatial/guided_filter.h"
#include "tests/reference/guided_filter.h"
#include "tests/spatial/guided_case.h"
#include "tests/support/kernel_test.h"

namespace eigenlight {
namespace {

using test::distance;
using test::GuidedCase;
using test::random;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

EL_KERNEL_TEST(GuidedFilter, MatchesTheReference) {
  const GuidedCase c(extent);
  for (const int radius : {1, 5, 8}) {
    const GuidedOptions options{.radius = radius};
    const Planes<3> wanted = reference::guided_filter(c.inputs(), options);
    on_every_target(
        [&] { EXPECT_LT(distance(c.filter(options), wanted), 2e-5) << "radius " << radius; });
  }
}

EL_KERNEL_TEST(GuidedFilter, MatchesTheReferenceWithFewerGuides) {
  const GuidedCase c(extent);
  for (const Guides guides : {Guides::kGrayNormal, Guides::kNormal, Guides::kNormalDepth}) {
    const GuidedOptions options{.radius = 5, .guides = guides};
    const Planes<3> wanted = reference::guided_filter(c.inputs(), options);
    on_every_target(
        [&] { EXPECT_LT(distance(c.filter(options), wanted), 2e-5) << static_cast<int>(guides); });
  }
}

TEST(GuidedFilter, MatchesTheReferenceAtWideRadii) {
  const GuidedCase c({140, 80});
  const GuidedOptions options{.radius = 16};
  EXPECT_LT(distance(c.filter(options), reference::guided_filter(c.inputs(), options)), 2e-5);
  const GuidedCase small({150, 20});
  const GuidedOptions widest{.radius = 32};
  EXPECT_LT(distance(small.filter(widest), reference::guided_filter(small.inputs(), widest)), 2e-5);
}

TEST(GuidedFilter, UnselectedTilesDoNotChange) {
  GuidedCase c({150, 70});
  c.wanted.fill(0);
  c.wanted(100, 69) = 1;
  const Planes<3> all = GuidedCase({150, 70}).filter();
  Planes<3> out = make_planes<3>(c.extent);
  for (auto& plane : out) plane.fill(-7.0f);
  GuidedFilter filter(c.extent, {});
  EXPECT_EQ(filter.process(c.inputs(), out), 150 * 70 - 64 * 6);
  EXPECT_EQ(out[0](100, 63), -7.0f);
  EXPECT_EQ(out[0](63, 69), -7.0f);
  EXPECT_EQ(out[0](70, 66), all[0](70, 66));
  EXPECT_NE(out[0](70, 66), -7.0f);
}

// Which tiles are filtered in one go changes no bit.
TEST(GuidedFilter, OtherSelectedTilesDoNotChangeTheBits) {
  for (const int radius : {3, 12}) {
    const GuidedOptions options{.radius = radius};
    GuidedCase c({330, 270});
    const Planes<3> all = c.filter(options);
    c.wanted.fill(0);
    for (int y = 0; y < 270; y += 64) {
      for (int x = 0; x < 330; x += 64) c.wanted(x, y) = random(x, y, 70) < 0.5f ? 1 : 0;
    }
    Planes<3> some = make_planes<3>(c.extent);
    GuidedFilter filter(c.extent, options);
    EXPECT_GT(filter.process(c.inputs(), some), 64 * 64);
    for (int y = 0; y < 270; ++y) {
      for (int x = 0; x < 330; ++x) {
        const bool wanted = c.wanted(x / 64 * 64, y / 64 * 64) != 0;
        ASSERT_EQ(some[2](x, y), wanted ? all[2](x, y) : 0.0f) << x << ", " << y;
      }
    }
  }
}

TEST(GuidedFilter, ThreadCountDoesNotChangeTheBits) {
  const GuidedCase c({191, 107});
  set_thread_count(1);
  const Planes<3> one = c.filter();
  set_thread_count(3);
  const Planes<3> three = c.filter();
  set_thread_count(0);
  Planes<3> again = make_planes<3>(c.extent);
  GuidedFilter filter(c.extent, {});
  for (int i = 0; i < 2; ++i) EXPECT_EQ(filter.process(c.inputs(), again), 0);
  for (int y = 0; y < 107; ++y) {
    const std::size_t bytes = 191 * sizeof(float);
    ASSERT_EQ(std::memcmp(one[2].row(y), three[2].row(y), bytes), 0);
    ASSERT_EQ(std::memcmp(one[2].row(y), again[2].row(y), bytes), 0);
  }
}

TEST(GuidedFilter, RejectsBadOptionsAndSizes) {
  const FloatTrapsOff nan_is_meant;
  EXPECT_THROW(GuidedFilter({8, 8}, {.radius = 0}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.radius = 33}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.guides = Guides{2}}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.epsilon_normal = 0.0f}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({8, 8}, {.epsilon_depth = kNan}), std::invalid_argument);
  EXPECT_THROW(GuidedFilter({0, 8}, {}), std::invalid_argument);
  GuidedCase c({20, 20});
  Planes<3> out = make_planes<3>({20, 21});
  GuidedFilter filter(c.extent, {});
  EXPECT_THROW(filter.process(c.inputs(), out), std::invalid_argument);
  EXPECT_THROW(filter.process(c.inputs(), c.signal), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
