#include "spatial/soft_atrous.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "frame/float_traps.h"
#include "frame/luminance.h"
#include "frame/random.h"
#include "tests/reference/soft_atrous.h"
#include "tests/support/compare.h"
#include "tests/support/kernel_test.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// Two walls that meet at x = 20, with noise in all guides, and sky in one column.
FrameInput noisy_frame(Extent extent, int sky) {
  FrameInput frame;
  frame.resize_input(extent);
  // Padding shows a surface.
  frame.surface.id.fill(1);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const auto draw = [&](std::uint32_t key) { return to_unit(hash_key(key, x, y)) - 0.5f; };
      const bool left = x < 20;
      frame.surface.depth(x, y) = (left ? 3.0f : 5.0f) * (1.0f + 0.02f * draw(1));
      frame.surface.id(x, y) = x == sky ? 0 : 1;
      for (int c = 0; c < 3; ++c) {
        frame.surface.normal[c](x, y) =
            (c == (left ? 0 : 2) ? 0.9f : 0.0f) + 0.1f * draw(2 + static_cast<std::uint32_t>(c));
        frame.surface.albedo[c](x, y) = 0.5f + 0.2f * draw(5 + static_cast<std::uint32_t>(c));
      }
    }
  }
  return frame;
}

FrameInput noisy_frame(Extent extent) { return noisy_frame(extent, extent.width - 1); }

struct Picture {
  Planes<3> light;
  Plane<float> variance;
};

Picture noisy_light(const FrameInput& frame, float noise) {
  const Extent extent = frame.extent();
  Picture made{make_planes<3>(extent), Plane<float>(extent)};
  // Padding is like the light beside it.
  for (auto& plane : made.light) plane.fill(2.0f);
  made.variance.fill(1.0f);
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

// A picture without what shows no surface, which gives nothing.
reference::SoftPicture twin_of(const Picture& picture, const FrameInput& frame) {
  reference::SoftPicture twin{frame.extent(), {}};
  for (int y = 0; y < frame.extent().height; ++y) {
    for (int x = 0; x < frame.extent().width; ++x) {
      const bool is_surface = frame.surface.id(x, y) != 0;
      const auto at = [&](const Plane<float>& p) {
        return is_surface ? static_cast<double>(p(x, y)) : 0.0;
      };
      twin.pixels.push_back(
          {at(picture.light[0]), at(picture.light[1]), at(picture.light[2]), at(picture.variance)});
    }
  }
  return twin;
}

void expect_near(const Picture& found, const reference::SoftPicture& twin) {
  for (int y = 0; y < twin.extent.height; ++y) {
    for (int x = 0; x < twin.extent.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(found.light[c](x, y), twin.at(x, y)[c], 2e-4 * twin.at(x, y)[c])
            << x << ' ' << y;
      }
      ASSERT_NEAR(found.variance(x, y), twin.at(x, y)[3], 2e-3 * twin.at(x, y)[3] + 1e-7);
    }
  }
}

void expect_twin(const SoftAtrousOptions& options, const GuideWidths& widths) {
  const FrameInput frame = noisy_frame({41, 23});
  Picture picture = noisy_light(frame, 0.4f);
  reference::SoftPicture twin = twin_of(picture, frame);
  const Plane<PackedGuide> guides = packed(frame, widths);
  filter(guides, options, picture);
  const reference::SoftFilter slow(guides, options);
  for (int i = 0; i < options.passes; ++i) twin = slow.pass(twin, 5.0, i);
  expect_near(picture, twin);
}

TEST(SoftAtrous, EqualsItsTwin) {
  expect_twin({.passes = 3, .radius = 2}, {});
  expect_twin({.passes = 2, .radius = 1}, {.normal = 0.5f, .color = 0.3f, .depth = 0.2f});
}

// A layer against the twin, and the bits of one with bad pixels, which the twin does not know.
EL_KERNEL_TEST(SoftAtrous, HasTheSameBitsOnEveryTarget) {
  const FrameInput frame = noisy_frame(extent, extent.width / 2);
  // Padding, whose guides are 0, would have weight.
  const Plane<PackedGuide> guides =
      packed(frame, {.normal = 10.0f, .color = 10.0f, .depth = 10.0f});
  const SoftAtrousOptions options{.passes = extent.width > 100 ? 2 : 5, .radius = 1};
  reference::SoftPicture twin = twin_of(noisy_light(frame, 0.4f), frame);
  const reference::SoftFilter slow(guides, options);
  for (int i = 0; i < options.passes; ++i) twin = slow.pass(twin, 5.0, i);
  std::optional<Picture> first_bad;
  on_every_target([&] {
    Picture good = noisy_light(frame, 0.4f), bad = noisy_light(frame, 0.2f);
    bad.light[1](extent.width / 4, extent.height / 2) = std::numeric_limits<float>::quiet_NaN();
    bad.variance(extent.width / 3, 0) = std::numeric_limits<float>::infinity();
    SoftAtrous filter(extent, options);
    const SoftLayer layers[] = {{&good.light, &good.variance, 5.0f},
                                {&bad.light, &bad.variance, 3.0f}};
    filter.process(guides, layers);
    expect_near(good, twin);
    if (!first_bad) {
      first_bad = std::move(bad);
      return;
    }
    EXPECT_TRUE(planes_equal(bad.light, first_bad->light));
    EXPECT_TRUE(planes_equal(bad.variance, first_bad->variance));
  });
}

// In double, over the pixels that count.
double variance_around(const FrameInput& frame, const Planes<3>& light, int x, int y) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  for (int qy = y - 2; qy <= y + 2; ++qy) {
    for (int qx = x - 2; qx <= x + 2; ++qx) {
      if (!frame.extent().contains(qx, qy) || frame.surface.id(qx, qy) == 0) continue;
      const double l = static_cast<double>(luminance(light, qx, qy));
      if (!std::isfinite(l)) continue;
      count += 1.0, sum += l, squares += l * l;
    }
  }
  return count > 1.0 ? squares / count - std::pow(sum / count, 2.0) : 0.0;
}

EL_KERNEL_TEST(VarianceOfFrame, EqualsSumsInDouble) {
  const FloatTrapsOff light_is_not_finite;
  const FrameInput frame = noisy_frame(extent, extent.width / 2);
  Picture picture = noisy_light(frame, 0.4f);
  picture.light[1](extent.width / 4, extent.height / 2) = std::numeric_limits<float>::quiet_NaN();
  picture.light[2](extent.width / 3, 0) = 1000.0f;
  Plane<float> wanted(extent), first;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      wanted(x, y) = static_cast<float>(variance_around(frame, picture.light, x, y));
    }
  }
  on_every_target([&] {
    Plane<float> found;
    variance_of_frame(frame, picture.light, found);
    EXPECT_TRUE(planes_near(found, wanted, {1e-4, 1e-7}));
    if (first.empty()) first = found.clone();
    EXPECT_TRUE(planes_equal(found, first));
  });
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
