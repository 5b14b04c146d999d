#include "spatial/soft_atrous.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frame/luminance.h"
#include "frame/random.h"
#include "tests/reference/soft_atrous.h"
#include "tests/support/compare.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// Two walls that meet at x = 20, with noise in all guides, and sky in the last column.
FrameInput noisy_frame(Extent extent) {
  FrameInput frame;
  frame.resize_input(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const auto draw = [&](std::uint32_t key) { return to_unit(hash_key(key, x, y)) - 0.5f; };
      const bool left = x < 20;
      frame.surface.depth(x, y) = (left ? 3.0f : 5.0f) * (1.0f + 0.02f * draw(1));
      frame.surface.id(x, y) = x + 1 == extent.width ? 0 : 1;
      for (int c = 0; c < 3; ++c) {
        frame.surface.normal[c](x, y) =
            (c == (left ? 0 : 2) ? 0.9f : 0.0f) + 0.1f * draw(2 + static_cast<std::uint32_t>(c));
        frame.surface.albedo[c](x, y) = 0.5f + 0.2f * draw(5 + static_cast<std::uint32_t>(c));
      }
    }
  }
  return frame;
}

struct Picture {
  Planes<3> light;
  Plane<float> variance;
};

Picture noisy_light(const FrameInput& frame, float noise) {
  const Extent extent = frame.extent();
  Picture made{make_planes<3>(extent), Plane<float>(extent)};
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const float draw = 2.0f * to_unit(hash_key(11, x, y)) - 1.0f;
      for (int c = 0; c < 3; ++c) {
        made.light[c](x, y) = (x < 20 ? 1.0f : 3.0f) * (1.0f + noise * draw);
      }
      made.variance(x, y) = (x < 20 ? 1.0f : 9.0f) * noise * noise / 3.0f;
    }
  }
  return made;
}

Plane<PackedGuide> packed(const FrameInput& frame, const GuideWidths& widths = {}) {
  Plane<PackedGuide> guides;
  pack_guides(frame, widths, guides);
  return guides;
}

void filter(const Plane<PackedGuide>& guides, const SoftAtrousOptions& options, Picture& picture) {
  SoftAtrous filter(guides.extent(), options);
  const SoftLayer layers[] = {{&picture.light, &picture.variance, 5.0f}};
  filter.process(guides, layers);
}

void expect_twin(const SoftAtrousOptions& options, const GuideWidths& widths) {
  const FrameInput frame = noisy_frame({41, 23});
  Picture picture = noisy_light(frame, 0.4f);
  reference::SoftPicture twin{frame.extent(), {}};
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 41; ++x) {
      // What shows no surface gives nothing.
      const bool is_surface = frame.surface.id(x, y) != 0;
      const auto at = [&](const Plane<float>& p) {
        return is_surface ? static_cast<double>(p(x, y)) : 0.0;
      };
      twin.pixels.push_back(
          {at(picture.light[0]), at(picture.light[1]), at(picture.light[2]), at(picture.variance)});
    }
  }
  const Plane<PackedGuide> guides = packed(frame, widths);
  filter(guides, options, picture);
  const reference::SoftFilter slow(guides, options);
  for (int i = 0; i < options.passes; ++i) twin = slow.pass(twin, 5.0, i);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 41; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(picture.light[c](x, y), twin.at(x, y)[c], 2e-4 * twin.at(x, y)[c])
            << x << ' ' << y;
      }
      ASSERT_NEAR(picture.variance(x, y), twin.at(x, y)[3], 2e-3 * twin.at(x, y)[3] + 1e-7);
    }
  }
}

TEST(SoftAtrous, EqualsItsTwin) {
  expect_twin({.passes = 3, .radius = 2}, {});
  expect_twin({.passes = 2, .radius = 1}, {.normal = 0.5f, .color = 0.3f, .depth = 0.2f});
}

// Light over both walls is the same before and after, and most noise is gone.
TEST(SoftAtrous, RemovesNoiseAndKeepsLightAndEdges) {
  const FrameInput frame = noisy_frame({64, 48});
  Picture picture = noisy_light(frame, 0.5f);
  double before[2] = {}, after[2] = {}, error = 0.0;
  const auto sum = [&](double* sums) {
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 63; ++x) {
        sums[x < 20 ? 0 : 1] += static_cast<double>(luminance(picture.light, x, y));
      }
    }
  };
  sum(before);
  filter(packed(frame), {}, picture);
  sum(after);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 63; ++x) {
      const double truth = x < 20 ? 1.0 : 3.0;
      error += std::pow(static_cast<double>(luminance(picture.light, x, y)) / truth - 1.0, 2.0);
    }
  }
  EXPECT_NEAR(after[0] / before[0], 1.0, 0.02);
  EXPECT_NEAR(after[1] / before[1], 1.0, 0.02);
  EXPECT_LT(error / (63 * 48), 0.25 / 3.0 / 50.0);
}

TEST(SoftAtrous, AnOutlierSpreadsItsLight) {
  const FrameInput frame = noisy_frame({64, 48});
  Picture picture = noisy_light(frame, 0.5f);
  for (int c = 0; c < 3; ++c) picture.light[c](40, 24) = 60.0f;
  variance_of_frame(frame, picture.light, picture.variance);
  filter(packed(frame), {}, picture);
  EXPECT_LT(picture.light[0](40, 24), 12.0f);
}

TEST(SoftAtrous, PixelsThatAreNotFiniteAreFilledAndHarmNoOthers) {
  const FrameInput frame = noisy_frame({41, 23});
  Picture good = noisy_light(frame, 0.1f), bad = noisy_light(frame, 0.1f);
  bad.light[1](10, 10) = std::numeric_limits<float>::quiet_NaN();
  bad.light[0](30, 12) = std::numeric_limits<float>::infinity();
  filter(packed(frame), {}, good);
  filter(packed(frame), {}, bad);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 40; ++x) {
      ASSERT_NEAR(bad.light[0](x, y), good.light[0](x, y), 0.1f * good.light[0](x, y));
    }
  }
}

TEST(SoftAtrous, LayersDoNotMix) {
  const FrameInput frame = noisy_frame({41, 23});
  Picture alone = noisy_light(frame, 0.4f), one = noisy_light(frame, 0.4f),
          two = noisy_light(frame, 0.1f);
  filter(packed(frame), {}, alone);
  SoftAtrous both(frame.extent(), {});
  const SoftLayer layers[] = {{&one.light, &one.variance, 5.0f}, {&two.light, &two.variance, 3.0f}};
  both.process(packed(frame), layers);
  EXPECT_TRUE(planes_equal(one.light, alone.light));
}

TEST(SoftAtrous, OptionsAreChecked) {
  EXPECT_THAT(
      [] {
        SoftAtrous({8, 8}, {.passes = 7});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("passes 7")));
  EXPECT_THAT(
      [] {
        SoftAtrous({8, 8}, {.radius = 3});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("radius 3")));
}

TEST(SoftAtrous, GuidesOfAnotherSizeAreRefused) {
  const FrameInput frame = noisy_frame({41, 23});
  Picture picture = noisy_light(frame, 0.4f);
  SoftAtrous filter({40, 23}, {});
  const SoftLayer layers[] = {{&picture.light, &picture.variance, 5.0f}};
  EXPECT_THAT([&] { filter.process(packed(frame), layers); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("guides of 41x23 pixels")));
}

}  // namespace
}  // namespace eigenlight
