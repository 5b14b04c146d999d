#include "temporal/gather/gather.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>

#include "frame/random.h"
#include "frame/tiles.h"
#include "tests/reference/gather.h"
#include "tests/support/compare.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Extent kExtent{37, 26};
constexpr std::size_t kLayers = 2;

// Uniform in [-1, 1).
float draw(std::uint32_t key, int x, int y, int what) {
  return 2.0f * to_unit(hash_key(key, x, y, what)) - 1.0f;
}

// Guides that differ by some widths, where a tenth of the pixels shows no surface.
Plane<PackedGuide> random_guides(std::uint32_t key) {
  Plane<PackedGuide> guides(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      PackedGuide& to = guides(x, y);
      for (int i = 0; i < 6; ++i) {
        to.normal_color[static_cast<std::size_t>(i)] =
            static_cast<std::int16_t>(90.0f * draw(key, x, y, i) + (x < 20 ? 0.0f : 120.0f));
      }
      to.depth = static_cast<std::int16_t>(90.0f * draw(key, x, y, 6));
      to.other = static_cast<std::int16_t>(draw(key, x, y, 7) < -0.8f ? 2048 : 0);
    }
  }
  return guides;
}

FrameLink random_link(std::uint32_t key, float step) {
  FrameLink link(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      if (draw(key, x, y, 10) < -0.7f) continue;
      link(x, y) = {step + draw(key, x, y, 11), draw(key, x, y, 12), 0.2f * draw(key, x, y, 13), 1};
    }
  }
  return link;
}

LightRecord random_lights(std::uint32_t key) {
  LightRecord record(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const auto at = [&](int what) { return 1.0f + 0.8f * draw(key, x, y, 20 + what); };
      if (draw(key, x, y, 30) < -0.7f) continue;  // light is not finite, or there is no surface
      record(x, y) = {at(0), at(1), at(2), at(3), 0.1f * at(4), at(5), 1.0f, 0.0f};
    }
  }
  return record;
}

ColorRecord random_colors(std::uint32_t key) {
  ColorRecord record(kExtent);
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const auto at = [&](int what) {
        return static_cast<std::uint16_t>(16000.0f + 3000.0f * draw(key, x, y, 40 + what));
      };
      if (draw(key, x, y, 50) < -0.7f) continue;
      record(x, y) = {at(0), at(1), at(2), 1};
    }
  }
  return record;
}

// All that gather() reads: three frames before the one at hand, and four after it.
struct Shot {
  Shot() {
    for (std::uint32_t f = 0; f < 7; ++f) {
      guides.push_back(random_guides(100 + f));
      links.push_back(random_link(200 + f, f < 3 ? -0.6f : 0.6f));
      for (std::uint32_t i = 0; i < kLayers; ++i) lights.push_back(random_lights(300 + 10 * f + i));
      colors.push_back(random_colors(400 + f));
    }
    walks.resize(2);
    for (std::size_t f = 0; f < 7; ++f) {
      GatherStep& step = walks[f < 3 ? 0 : 1].emplace_back();
      step.link = &links[f];
      step.guides = &guides[f];
      for (std::size_t i = 0; i < kLayers; ++i) step.lights.push_back(&lights[f * kLayers + i]);
      step.colors.push_back(&colors[f]);
    }
    for (std::uint32_t i = 0; i < kLayers; ++i) own.push_back(random_lights(500 + i));
  }

  std::vector<Plane<PackedGuide>> guides;
  std::vector<FrameLink> links;
  std::vector<LightRecord> lights, own;
  std::vector<ColorRecord> colors;
  ColorRecord own_color = random_colors(550);
  std::vector<GatherWalk> walks;
  Plane<PackedGuide> at_hand = random_guides(1);
  GuideWidths widths;
};

// What gather() makes of a shot.
struct Gathered {
  explicit Gathered(const Shot& shot, LightTest test = {}, float width = 0.2f) {
    for (std::size_t i = 0; i < kLayers; ++i) {
      light[i] = make_planes<3>(kExtent);
      variance[i] = Plane<float>(kExtent);
      test.tolerance = i == 0 ? 0.0f : 0.3f;
      layers.push_back({&shot.own[i], test, &light[i], &variance[i]});
    }
    const std::array<GatherColor, 1> colors{{{&shot.own_color, width, &color}}};
    gather(shot.at_hand, shot.widths, shot.walks, layers, colors);
  }
  Gathered(const Gathered&) = delete;
  Gathered& operator=(const Gathered&) = delete;

  std::array<Planes<3>, kLayers> light;
  std::array<Plane<float>, kLayers> variance;
  Planes<3> color = make_planes<3>(kExtent);
  std::vector<GatherLayer> layers;
};

// Off by how much of the wanted value, which may be NaN.
double error_of(float found, double wanted) {
  if (std::isnan(wanted) || std::isnan(found))
    return std::isnan(wanted) == std::isnan(found) ? 0 : 1;
  return std::abs(static_cast<double>(found) - wanted) / (std::abs(wanted) + 0.01);
}

void expect_twin(const Shot& shot, const LightTest& test, float width) {
  const Gathered found(shot, test, width);
  const reference::SlowGather twin({shot.at_hand, shot.widths, shot.walks});
  int changed = 0, other_steps = 0;
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      if (!shows_surface(shot.at_hand(x, y))) continue;
      double error = 0.0;
      for (std::size_t i = 0; i < kLayers; ++i) {
        const reference::GatherPixel wanted = twin.pixel(found.layers[i], i, x, y);
        error = std::max(error, error_of(found.variance[i](x, y), wanted.variance));
        for (std::size_t c = 0; c < 3; ++c) {
          error = std::max(error, error_of(found.light[i][c](x, y), wanted.light[c]));
        }
        changed += found.light[i][0](x, y) != shot.own[i](x, y).r;
      }
      if (shot.own_color(x, y).usable != 0) {
        const std::array<double, 3> wanted =
            twin.color(shot.own_color, static_cast<double>(width), 0, x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          error = std::max(error, error_of(found.color[c](x, y), wanted[c]));
        }
      }
      // Float and double may round a depth to different steps, in one pixel of some thousands.
      other_steps += error > 1e-4;
      ASSERT_LT(error, 2e-2) << "pixel " << x << ' ' << y;
    }
  }
  EXPECT_LE(other_steps, 5);
  EXPECT_GT(changed, 1000);
}

TEST(Gather, EqualsItsTwin) {
  const Shot shot;
  expect_twin(shot, {}, 0.2f);
  expect_twin(shot, {.soft = 0.5f, .slope = 3.0f}, 0.05f);
  expect_twin(shot, {.soft = 0.0f, .slope = 0.0f}, 10.0f);
}

TEST(Gather, SameBitsOnAnyNumberOfThreads) {
  const Shot shot;
  set_thread_count(1);
  const Gathered one(shot);
  set_thread_count(2);
  for (const std::uint32_t order : {0u, 7u}) {
    set_loop_order(order);
    const Gathered two(shot);
    for (std::size_t i = 0; i < kLayers; ++i) {
      EXPECT_TRUE(planes_equal(two.light[i], one.light[i])) << i;
      EXPECT_TRUE(planes_equal(two.variance[i], one.variance[i])) << i;
    }
    EXPECT_TRUE(planes_equal(two.color, one.color));
  }
  set_loop_order(0);
  set_thread_count(0);
}

TEST(Gather, BadOptionsAreNamed) {
  EXPECT_THAT([] { LightTest{.tolerance = 1.5f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("tolerance 1.5")));
  EXPECT_THAT([] { LightTest{.soft = -1.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("soft -1")));
  EXPECT_THAT([] { LightTest{.slope = 101.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("slope 101")));
}

}  // namespace
}  // namespace eigenlight
