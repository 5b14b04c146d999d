#include "spatial/rivals/pyramid_filter.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/reference/pyramid.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

// Surfaces, sky, bent normals, NaN and Inf in the light, and samples that are missing.
struct Case {
  explicit Case(Extent extent)
      : frame(make_random_frame({.extent = extent, .seed = 8}, 0)),
        weight(random_plane(extent, 21, 0.5f, 4.0f)) {
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        if (PixelRandom(22, x, y).uniform() < 0.1f) weight(x, y) = 0.0f;
      }
    }
  }

  [[nodiscard]] Planes<3> filter(const GlobalIlluminationEdge& edge) const {
    Planes<3> out = make_planes<3>(frame.extent());
    PyramidFilter(frame.extent(), edge).process({frame, frame.lights[0].radiance, weight}, out);
    return out;
  }
  [[nodiscard]] Planes<3> twin(const GlobalIlluminationEdge& edge) const {
    const Plane<float> attributes = reference::surface_attributes(frame.surface);
    return reference::pyramid(reference::global_illumination_range(edge),
                              {attributes, frame.lights[0].radiance, weight},
                              trained_pyramid_table());
  }

  Frame frame;
  Plane<float> weight;
};

EL_KERNEL_TEST(PyramidFilter, MatchesTheReference) {
  const Case c(extent);
  for (const auto& [radius, gamma] : {std::pair(0.4f, 1.0f), std::pair(3.0f, 0.0f),
                                      std::pair(24.0f, 0.0f), std::pair(24.0f, 1.0f)}) {
    const testing::ScopedTrace trace(__FILE__, __LINE__, fmt::format("{}, {}", radius, gamma));
    const GlobalIlluminationEdge edge{.blur_radius = radius, .gamma_scale = gamma};
    const Planes<3> wanted = c.twin(edge);
    on_every_target([&] {
      const Planes<3> found = c.filter(edge);
      EXPECT_LE(reference::share_beyond(2e-4, found, wanted), 0.02);
      EXPECT_LE(reference::share_beyond(1e-2, found, wanted), 1e-3);
    });
  }
}

TEST(PyramidFilter, MatchesTheReferenceAtTheWidestRadius) {
  const Case c({150, 90});
  const GlobalIlluminationEdge edge{.blur_radius = 64.0f};
  EXPECT_LE(reference::share_beyond(2e-4, c.filter(edge), c.twin(edge)), 0.02);
}

TEST(PyramidFilter, PixelsWithoutSurfaceAreZeroAndDoNotSpread) {
  Case clean({97, 61}), dirty({97, 61});
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 97; ++x) {
      if (clean.frame.surface.id(x, y) != 0) continue;
      dirty.frame.surface.normal[1](x, y) = std::numeric_limits<float>::quiet_NaN();
      dirty.frame.surface.depth(x, y) = 1.0f;
      dirty.frame.lights[0].radiance[0](x, y) = 1e30f;
    }
  }
  const Planes<3> out = dirty.filter({});
  EXPECT_TRUE(planes_equal(out, clean.filter({})));
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 97; ++x) {
      if (clean.frame.surface.id(x, y) == 0) {
        EXPECT_EQ(out[0](x, y), 0.0f);
      }
    }
  }
}

TEST(PyramidFilter, NonFiniteLightCountsAsMissing) {
  Case missing({70, 40}), broken({70, 40});
  for (auto* c : {&missing, &broken}) {
    for (auto& plane : c->frame.lights[0].radiance) plane = random_plane({70, 40}, 1, 0.0f, 2.0f);
  }
  missing.weight(33, 20) = 0.0f;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38f}) {
    broken.frame.lights[0].radiance[1](33, 20) = bad;
    EXPECT_TRUE(planes_equal(broken.filter({}), missing.filter({})));
  }
}

TEST(PyramidFilter, ConstantLightStaysConstant) {
  Case c({191, 107});
  for (auto& plane : c.frame.lights[0].radiance) plane.fill(0.7f);
  const Planes<3> out = c.filter({});
  for (int y = 0; y < 107; ++y) {
    for (int x = 0; x < 191; ++x) {
      if (out[2](x, y) != 0.0f) {
        ASSERT_NEAR(out[2](x, y), 0.7f, 1e-5f);
      }
      const bool used = c.frame.surface.id(x, y) != 0 && c.weight(x, y) > 0.0f;
      if (used) {
        ASSERT_GT(out[2](x, y), 0.0f);
      }
    }
  }
}

TEST(PyramidFilter, ThreadCountDoesNotChangeTheBits) {
  const Case c({191, 107});
  set_thread_count(1);
  const Planes<3> one = c.filter({});
  set_thread_count(3);
  const Planes<3> three = c.filter({});
  set_thread_count(0);
  EXPECT_TRUE(planes_equal(one, three));
  PyramidFilter filter(c.frame.extent(), {});
  Planes<3> again = make_planes<3>(c.frame.extent());
  for (int i = 0; i < 2; ++i)
    filter.process({c.frame, c.frame.lights[0].radiance, c.weight}, again);
  EXPECT_TRUE(planes_equal(one, again));
}

TEST(PyramidFilter, RejectsBadOptionsAndSizes) {
  EXPECT_THROW(PyramidFilter({8, 8}, {.normal_power = 0.0f}), std::invalid_argument);
  EXPECT_THROW(PyramidFilter({8, 8}, {.depth_scale = -1.0f}), std::invalid_argument);
  EXPECT_THROW(PyramidFilter({8, 8}, {.blur_radius = 65.0f}), std::invalid_argument);
  EXPECT_THROW(PyramidFilter({8, 8}, {.gamma_scale = 1.5f}), std::invalid_argument);
  EXPECT_THROW(PyramidFilter({0, 8}, {}), std::invalid_argument);
  Case c({20, 20});
  PyramidFilter filter({20, 20}, {});
  Planes<3> out = make_planes<3>({20, 21});
  EXPECT_THROW(filter.process({c.frame, c.frame.lights[0].radiance, c.weight}, out),
               std::invalid_argument);
  EXPECT_THROW(
      filter.process({c.frame, c.frame.lights[0].radiance, c.weight}, c.frame.lights[0].radiance),
      std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
