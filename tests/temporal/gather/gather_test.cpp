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
constexpr std::size_t kLayers = 3;  // with a count, without one, without light in the first walk

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

LightChange random_change(std::uint32_t key) {
  Planes<3> here = make_planes<3>(kExtent), there = make_planes<3>(kExtent);
  FrameLink still(kExtent);
  still.fill({0.0f, 0.0f, 0.0f, 1.0f});
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        here[c](x, y) = 1.3f + draw(key, x / 16, y / 16, 40);
        there[c](x, y) = 1.0f;
      }
    }
  }
  LightChange change;
  change.find(here, there, still);
  return change;
}

// All that gather() reads: three frames before the one at hand, and four after it.
struct Shot {
  Shot() {
    for (std::uint32_t f = 0; f < 7; ++f) {
      guides.push_back(random_guides(100 + f));
      links.push_back(random_link(200 + f, f < 3 ? -0.6f : 0.6f));
      for (std::uint32_t i = 0; i < kLayers; ++i) lights.push_back(random_lights(300 + 10 * f + i));
      changes.push_back(random_change(400 + f));
    }
    walks.resize(2);
    for (std::size_t f = 0; f < 7; ++f) {
      GatherStep& step = walks[f < 3 ? 0 : 1].emplace_back();
      step.link = &links[f];
      step.guides = &guides[f];
      for (std::size_t i = 0; i < kLayers; ++i) {
        step.lights.push_back(i == 2 && f < 3 ? nullptr : &lights[f * kLayers + i]);
        step.changes.push_back(i == 1 ? nullptr : &changes[f]);
      }
    }
    // A frame amid others that gives no light; its change counts for those beyond it.
    walks[1][1].lights[0] = nullptr;
    for (std::uint32_t i = 0; i < kLayers; ++i) own.push_back(random_lights(500 + i));
  }

  std::vector<Plane<PackedGuide>> guides;
  std::vector<FrameLink> links;
  std::vector<LightRecord> lights, own;
  std::vector<LightChange> changes;
  std::vector<GatherWalk> walks;
  Plane<PackedGuide> at_hand = random_guides(1);
  GuideWidths widths;
};

// The estimates that gather() adds to.
struct Estimates {
  explicit Estimates(const Shot& shot) {
    for (std::size_t i = 0; i < kLayers; ++i) {
      light[i] = make_planes<3>(kExtent);
      variance[i] = Plane<float>(kExtent);
      count[i] = Plane<float>(kExtent);
      for (int y = 0; y < kExtent.height; ++y) {
        for (int x = 0; x < kExtent.width; ++x) fill(shot, i, x, y);
      }
      layers.push_back({&shot.own[i], &light[i], &variance[i], i == 1 ? nullptr : &count[i]});
    }
  }
  Estimates(const Estimates&) = delete;
  Estimates& operator=(const Estimates&) = delete;

  void fill(const Shot& shot, std::size_t i, int x, int y) {
    const RecordedLight& own = shot.own[i](x, y);
    const auto key = static_cast<std::uint32_t>(600 + i);
    const bool is_own = i == 1;
    light[i][0](x, y) = is_own ? own.r : 1.0f + draw(key, x, y, 0);
    light[i][1](x, y) = is_own ? own.g : 1.0f + draw(key, x, y, 1);
    light[i][2](x, y) = is_own ? own.b : 1.0f + draw(key, x, y, 2);
    variance[i](x, y) = is_own ? own.noise : 0.2f + 0.1f * draw(key, x, y, 3);
    count[i](x, y) = std::max(0.0f, 4.0f + 5.0f * draw(key, x, y, 4));
    if (own.usable == 0.0f) light[i][x % 3](x, y) = kNan;
    if (!is_own && (x + y) % 17 == 0) variance[i](x, y) = kNan;
  }

  std::array<Planes<3>, kLayers> light;
  std::array<Plane<float>, kLayers> variance, count;
  std::vector<GatherLayer> layers;
};

// Off by how much of the wanted value, which may be NaN.
double error_of(float found, double wanted) {
  if (std::isnan(wanted) || std::isnan(found))
    return std::isnan(wanted) == std::isnan(found) ? 0 : 1;
  return std::abs(static_cast<double>(found) - wanted) / (std::abs(wanted) + 0.01);
}

void expect_twin(const Shot& shot, const GatherOptions& options) {
  Estimates before(shot), found(shot);
  gather(shot.at_hand, shot.widths, shot.walks, found.layers, options);
  const reference::SlowGather twin({shot.at_hand, shot.widths, shot.walks, options});
  int changed = 0, other_steps = 0;
  for (std::size_t i = 0; i < kLayers; ++i) {
    for (int y = 0; y < kExtent.height; ++y) {
      for (int x = 0; x < kExtent.width; ++x) {
        const reference::GatherPixel wanted = twin.pixel(before.layers[i], i, x, y);
        double error = error_of(found.variance[i](x, y), wanted.variance);
        for (std::size_t c = 0; c < 3; ++c) {
          error = std::max(error, error_of(found.light[i][c](x, y), wanted.light[c]));
        }
        // Float and double may round a depth to different steps, in one pixel of some thousands.
        other_steps += error > 3e-5;
        ASSERT_LT(error, 1e-2) << "layer " << i << ", pixel " << x << ' ' << y;
        changed += found.light[i][0](x, y) != before.light[i][0](x, y);
      }
    }
  }
  EXPECT_LE(other_steps, 3);
  EXPECT_GT(changed, 1500);
}

TEST(Gather, EqualsItsTwin) {
  const Shot shot;
  expect_twin(shot, {});
  expect_twin(shot, {.soft = 0.5f, .slope = 3.0f, .change = 0.1f});
  expect_twin(shot, {.soft = 0.0f, .slope = 0.0f, .change = 10.0f});
}

TEST(Gather, SameBitsOnAnyNumberOfThreads) {
  const Shot shot;
  set_thread_count(1);
  Estimates one(shot);
  gather(shot.at_hand, shot.widths, shot.walks, one.layers, {});
  set_thread_count(2);
  for (const std::uint32_t order : {0u, 7u}) {
    set_loop_order(order);
    Estimates more(shot);
    gather(shot.at_hand, shot.widths, shot.walks, more.layers, {});
    for (std::size_t i = 0; i < kLayers; ++i) {
      EXPECT_TRUE(planes_equal(more.light[i], one.light[i]));
      EXPECT_TRUE(planes_equal(more.variance[i], one.variance[i]));
    }
  }
  set_loop_order(0);
  set_thread_count(0);
}

TEST(Gather, WithoutOtherFramesEstimatesStay) {
  const Shot shot;
  const Estimates before(shot);
  Estimates found(shot);
  gather(shot.at_hand, shot.widths, {}, found.layers, {});
  for (int y = 0; y < kExtent.height; ++y) {
    for (int x = 0; x < kExtent.width; ++x) {
      const float was = before.light[0][0](x, y), is = found.light[0][0](x, y);
      if (std::isnan(was)) {
        EXPECT_TRUE(std::isnan(is));
      } else {
        EXPECT_NEAR(is, was, 1e-6f * was);
      }
    }
  }
}

TEST(Gather, OptionsAreChecked) {
  EXPECT_THAT([] { GatherOptions{.soft = -1.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("soft -1")));
  EXPECT_THAT([] { GatherOptions{.slope = 101.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("slope 101")));
  EXPECT_THAT([] { GatherOptions{.change = 0.0f}.validate(); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("change 0")));
}

}  // namespace
}  // namespace eigenlight
