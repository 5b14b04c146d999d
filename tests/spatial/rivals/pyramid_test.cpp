#include "spatial/rivals/pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "frame/float_traps.h"
#include "frame/random.h"
#include "tests/reference/pyramid.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// Planes of several surfaces with bent normals and sky, noisy light, and missing samples.
struct Case {
  explicit Case(Extent size, int count = 4)
      : extent(size), attributes(size, count), signal(make_planes<3>(size)), weight(size) {
    const Frame frame = make_random_frame({.extent = size, .seed = 5}, 0);
    surface = reference::surface_attributes(frame.surface);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) fill(x, y);
    }
  }

  void fill(int x, int y) {
    PixelRandom random(11, x, y);
    for (auto& plane : signal) plane(x, y) = random.between(0.0f, 2.0f);
    weight(x, y) = random.uniform() < 0.1f ? 0.0f : random.between(0.5f, 4.0f);
    float* own = attributes.at(x, y);
    switch (attributes.channels()) {
      case 1:
        own[0] =
            std::round(random.between(0.0f, 3.0f) + 8.0f * to_unit(hash_key(3u, x / 16, y / 8)));
        break;
      case 5:
        own[4] = to_unit(hash_key(4u, x / 12, y / 12));
        [[fallthrough]];
      default:
        std::copy_n(surface.at(x, y), 4, own);
    }
  }

  template <typename Edge>
  [[nodiscard]] Planes<3> filter(const Edge& edge,
                                 const PyramidTable& table = trained_pyramid_table()) const {
    Planes<3> out = make_planes<3>(extent);
    Pyramid<Edge>(extent, edge, table).process(inputs(), out);
    return out;
  }
  [[nodiscard]] PyramidInputs inputs() const { return {attributes, signal, weight}; }

  Extent extent;
  Plane<float> surface, attributes;
  Planes<3> signal;
  Plane<float> weight;
};

constexpr Tolerance kSmall{1e-4, 1e-5};

EL_KERNEL_TEST(Pyramid, MatchesTheReferenceOnSurfaces) {
  const Case c(extent);
  for (const float radius : {0.0f, 0.4f, 5.0f, 64.0f}) {
    const GlobalIlluminationEdge edge{.blur_radius = radius, .gamma_scale = 0.5f};
    const Planes<3> wanted = reference::pyramid(reference::global_illumination_range(edge),
                                                c.inputs(), trained_pyramid_table());
    on_every_target([&] {
      EXPECT_LE(reference::share_beyond(2e-4, c.filter(edge), wanted), 0.02) << "radius " << radius;
    });
  }
}

TEST(Pyramid, MatchesTheReferenceWithoutTraining) {
  const Case c({65, 17});
  const GlobalIlluminationEdge edge{.blur_radius = 12.0f};
  EXPECT_TRUE(planes_near(c.filter(edge, untrained_pyramid_table()),
                          reference::pyramid(reference::global_illumination_range(edge), c.inputs(),
                                             untrained_pyramid_table()),
                          kSmall));
}

EL_KERNEL_TEST(Pyramid, MatchesTheReferenceForVaryingRoughness) {
  const Case c(extent, 5);
  const ReflectionEdge edge;
  const Planes<3> wanted =
      reference::pyramid(reference::reflection_range(edge), c.inputs(), trained_pyramid_table());
  on_every_target([&] { EXPECT_LE(reference::share_beyond(2e-4, c.filter(edge), wanted), 0.02); });
}

EL_KERNEL_TEST(Pyramid, MatchesTheReferenceForCirclesOfConfusion) {
  const Case c(extent, 1);
  const DepthOfFieldEdge edge;
  const Planes<3> wanted = reference::pyramid(reference::depth_of_field_range(edge), c.inputs(),
                                              trained_pyramid_table());
  on_every_target([&] { EXPECT_TRUE(planes_near(c.filter(edge), wanted, kSmall)); });
}

EL_KERNEL_TEST(Pyramid, MatchesTheReferenceForParticles) {
  const Case c(extent, 1);
  const ParticleEdge edge{.depth_scale = 0.05f};
  const Planes<3> wanted =
      reference::pyramid(reference::particle_range(edge), c.inputs(), trained_pyramid_table());
  on_every_target([&] { EXPECT_TRUE(planes_near(c.filter(edge), wanted, kSmall)); });
}

TEST(Pyramid, ConstantLightStaysConstant) {
  Case c({97, 61});
  for (auto& plane : c.signal) plane.fill(2.5f);
  const Planes<3> out = c.filter(GlobalIlluminationEdge{});
  for (int y = 0; y < 61; ++y) {
    for (int x = 0; x < 97; ++x) {
      if (out[0](x, y) != 0.0f) {
        ASSERT_NEAR(out[0](x, y), 2.5f, 1e-5f) << x << ", " << y;
      }
      if (c.weight(x, y) > 0.0f && c.attributes.at(x, y)[3] > 0.0f) {
        ASSERT_GT(out[0](x, y), 0.0f) << x << ", " << y;
      }
    }
  }
}

TEST(Pyramid, NonFiniteLightDoesNotSpread) {
  const FloatTrapsOff nan_is_meant;
  Case missing({70, 40}), broken({70, 40});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 70; ++x) {
      if ((x * 7 + y * 3) % 11 != 0) continue;
      missing.weight(x, y) = 0.0f;
      constexpr float kBad[4] = {kNan, kInf, -kInf, 3e38f};
      broken.signal[static_cast<std::size_t>(x % 3)](x, y) = kBad[y % 4];
      if (x % 2 == 0) broken.weight(x, y) = 0.0f;
    }
  }
  const GlobalIlluminationEdge edge;
  EXPECT_TRUE(planes_equal(broken.filter(edge), missing.filter(edge)));
}

// Two perpendicular walls with different light: none of it crosses the edge at any radius.
TEST(Pyramid, EdgesOfTheGuideAreKept) {
  Case c({96, 64});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const bool left = x < 37;
      float* own = c.attributes.at(x, y);
      own[0] = left ? 1.0f : 0.0f, own[1] = 0.0f, own[2] = left ? 0.0f : 1.0f, own[3] = 2.0f;
      for (auto& plane : c.signal) plane(x, y) = left ? 5.0f : 1.0f;
    }
  }
  for (const float radius : {1.0f, 8.0f, 64.0f}) {
    const Planes<3> out = c.filter(GlobalIlluminationEdge{.blur_radius = radius});
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 96; ++x) ASSERT_NEAR(out[1](x, y), x < 37 ? 5.0f : 1.0f, 1e-5f);
    }
  }
}

// Without edges the filter is a convolution. Its kernel, averaged over the four positions in
// coarser pixels, differs from the Gaussian by a third of its norm (untrained weights: two thirds).
TEST(Pyramid, PointSpreadsLikeAGaussian) {
  for (const int radius : {2, 6, 16}) {
    Case c({161, 161}, 3);
    c.attributes.fill(0.5f);
    c.weight.fill(1.0f);
    double spread = 0.0, sum = 0.0, off = 0.0, length = 0.0;
    const auto wanted = static_cast<double>(pyramid_sigma(static_cast<float>(radius)));

    for (int p = 0; p < 4; ++p) {
      for (auto& plane : c.signal) plane.fill(0.0f);
      const int px = 80 + p % 2, py = 80 + p / 2;
      c.signal[0](px, py) = 1.0f;
      const Planes<3> out = c.filter(ColorEdge{.blur_radius = static_cast<float>(radius)});
      for (int y = 0; y < 161; ++y) {
        for (int x = 0; x < 161; ++x) {
          const auto v = static_cast<double>(out[0](x, y));
          sum += v;
          const double square = (x - px) * (x - px) + (y - py) * (y - py);
          const double gaussian = std::exp(-square / (2.0 * wanted * wanted)) /
                                  (2.0 * std::numbers::pi * wanted * wanted);
          spread += v * square;
          off += (v - gaussian) * (v - gaussian);
          length += gaussian * gaussian;
        }
      }
    }
    const double sigma = std::sqrt(spread / sum / 2.0);
    EXPECT_NEAR(sum / 4.0, 1.0, 0.01) << radius;
    // The table is trained to remove noise too, which widens the kernel by up to 18 %. Untrained
    // weights widen it by 120 to 160 %.
    EXPECT_GE(sigma / wanted, 1.0) << radius;
    EXPECT_LE(sigma / wanted, 1.2) << radius;
    EXPECT_LT(std::sqrt(off / length), 0.35) << radius;
  }
}

// A blurred background neither takes light from focused pixels nor gives light to them.
TEST(Pyramid, FocusedPixelsStaySharp) {
  Case c({80, 60}, 1);
  c.weight.fill(1.0f);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const bool focused = x >= 30 && x < 50;
      c.attributes(x, y) = focused ? 0.0f : 24.0f;
      for (auto& plane : c.signal) plane(x, y) = focused ? 1.0f : 0.0f;
    }
  }
  const Planes<3> out = c.filter(DepthOfFieldEdge{});
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      ASSERT_NEAR(out[0](x, y), x >= 30 && x < 50 ? 1.0f : 0.0f, 1e-3f) << x << ", " << y;
    }
  }
}

TEST(Pyramid, ThreadCountDoesNotChangeTheBits) {
  const Case c({191, 107});
  const GlobalIlluminationEdge edge;
  set_thread_count(1);
  const Planes<3> one = c.filter(edge);
  set_thread_count(3);
  const Planes<3> three = c.filter(edge);
  set_thread_count(0);
  EXPECT_TRUE(planes_equal(one, three));
}

TEST(Pyramid, RejectsPlanesOfAnotherShape) {
  Case c({20, 20});
  Pyramid<GlobalIlluminationEdge> pyramid({20, 20}, {});
  Planes<3> out = make_planes<3>({20, 21});
  EXPECT_THROW(pyramid.process(c.inputs(), out), std::invalid_argument);
  EXPECT_THROW(pyramid.process(c.inputs(), c.signal), std::invalid_argument);
  const Plane<float> three({20, 20}, 3);
  Planes<3> fits = make_planes<3>({20, 20});
  EXPECT_THROW(pyramid.process({three, c.signal, c.weight}, fits), std::invalid_argument);
}

}  // namespace
}  // namespace eigenlight
