#include "temporal/change/correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "frame/float_traps.h"
#include "tests/support/compare.h"
#include "tests/support/extents.h"
#include "tests/support/kernel_test.h"
#include "tests/support/random_frames.h"

namespace eigenlight {
namespace {

constexpr double kVariance = 0.3;

// A wall of noise of variance kVariance around `mean`, predicted as 1 from a history of 16 frames.
struct Scene {
  explicit Scene(Extent extent)
      : guides(make_random_frame({.extent = extent, .sky = false, .disturbed = false}, 2)),
        residual(make_planes<3>(extent)),
        prediction(make_planes<3>(extent)),
        innovation(extent),
        age(extent),
        samples(extent),
        variance(extent) {
    guides.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60.0f, extent);
    guides.surface.id.fill(1);
    guides.surface.depth.fill(4.0f);
    for (std::size_t c = 0; c < 3; ++c) guides.surface.normal[c].fill(c == 2 ? -1.0f : 0.0f);
    age.fill(16.0f);
    samples.fill(1.0f);
    variance.fill(static_cast<float>(kVariance));
    set_light(1.0f);
  }
  void set_light(float mean, int first_column = 0) {
    const auto half = static_cast<float>(std::sqrt(3.0 * kVariance));
    for (auto& plane : prediction) plane.fill(1.0f);
    for (int y = 0; y < innovation.height(); ++y) {
      for (int x = 0; x < innovation.width(); ++x) {
        const float noise = PixelRandom(5, x, y).between(-half, half);
        set_residual(x, y, (x < first_column ? 0.0f : mean - 1.0f) + noise);
      }
    }
  }
  void set_residual(int x, int y, float value) {
    for (auto& plane : residual) plane(x, y) = value;
    innovation(x, y) = value;
  }
  [[nodiscard]] CorrectionInputs in() const {
    return {guides, residual, innovation, age, samples, variance};
  }
  double smooth(Correction& correction) {
    correction.prepare(in());
    CellFilter(innovation.extent(), {})
        .correct(std::array{CorrectionLayer{correction, guides, innovation}});
    return correction.share();
  }
  double run() {
    Correction correction(innovation.extent(), {});
    return run(correction);
  }
  // Leaves the corrected prediction.
  double run(Correction& correction) {
    const Rect all{0, 0, innovation.width(), innovation.height()};
    correction.read_geometry(guides.surface, all);
    correction.count_blocks(in(), all);
    const double share = smooth(correction);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < prediction[c].height(); ++y) {
        for (int x = 0; x < prediction[c].width(); ++x) {
          prediction[c](x, y) += correction.correction()[c](x, y);
        }
      }
    }
    return share;
  }
  Frame guides;
  Planes<3> residual, prediction;
  Plane<float> innovation, age, samples, variance;
};

TEST(Correction, SteadyLightGivesNoCorrection) {
  Scene scene({191, 107});
  Correction correction({191, 107}, {});
  EXPECT_EQ(scene.run(correction), 0.0);
  EXPECT_EQ(correction.skipped(), 191 * 107);
  for (int y = 0; y < 107; ++y) {
    for (int x = 0; x < 191; ++x) {
      ASSERT_EQ(correction.correction()[0](x, y), 0.0f);
      ASSERT_EQ(scene.prediction[0](x, y), 1.0f);
    }
  }
}

TEST(Correction, FollowsAChangeOfAllLight) {
  for (const float mean : {0.2f, 3.0f}) {
    Scene scene({191, 107});
    scene.set_light(mean);
    EXPECT_GT(scene.run(), 0.9);
    EXPECT_NEAR(scene.prediction[1](90, 50), mean, 0.1f * std::abs(mean - 1.0f) + 0.1f);
  }
}

TEST(Correction, InnovationLosesTheCorrection) {
  Scene scene({191, 107});
  scene.set_light(2.0f, 100);
  const Plane<float> before = scene.innovation.clone();
  Correction correction({191, 107}, {});
  (void)scene.run(correction);
  for (int y = 0; y < 107; ++y) {
    for (int x = 0; x < 191; ++x) {
      const float given = correction.correction()[1](x, y);
      ASSERT_NEAR(scene.innovation(x, y), before(x, y) - given, 1e-5f);
    }
  }
}

TEST(Correction, DistantTilesDoNotChange) {
  const Extent extent{512, 64};
  Scene scene(extent);
  scene.set_light(2.0f, 400);
  Correction correction(extent, {});
  EXPECT_GT(scene.run(correction), 0.0);
  // Gates look one coefficient tile around, are interpolated over another, and chance alone opens
  // few: the first half stays as it was.
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 200; ++x) ASSERT_EQ(scene.prediction[0](x, y), 1.0f) << x << ", " << y;
  }
  EXPECT_GE(correction.skipped(), 192 * 64);
}

TEST(Correction, CorrectionEndsWhenLightHasSettled) {
  Scene scene({65, 33});
  Correction correction({65, 33}, {});
  scene.set_light(3.0f);
  EXPECT_GT(scene.run(correction), 0.5);
  scene.set_light(1.0f);
  EXPECT_EQ(scene.run(correction), 0.0);
  for (int y = 0; y < 33; ++y) {
    for (int x = 0; x < 65; ++x) ASSERT_EQ(correction.correction()[2](x, y), 0.0f);
  }
}

TEST(Correction, UnconfirmedPixelsAreIgnored) {
  Scene scene({65, 33});
  scene.set_light(3.0f);
  scene.samples(30, 15) = 0.0f;
  scene.set_residual(30, 15, std::nanf(""));
  (void)scene.run();
  EXPECT_EQ(scene.prediction[0](30, 15), 1.0f);
  EXPECT_TRUE(std::isnan(scene.innovation(30, 15)));
  EXPECT_TRUE(std::isfinite(scene.prediction[0](31, 15)));
  EXPECT_NEAR(scene.prediction[0](31, 15), 3.0f, 0.4f);
}

// A cell of pixels without history must not count as a residual of 0: that would darken the cells
// beside it.
TEST(Correction, RegionWithoutHistoryDoesNotDarkenItsNeighbors) {
  Scene whole({96, 64}), half({96, 64});
  whole.set_light(3.0f);
  half.set_light(3.0f);
  for (int y = 0; y < 64; ++y) {
    for (int x = 40; x < 96; ++x) half.innovation(x, y) = std::nanf("");
  }
  (void)whole.run();
  (void)half.run();
  double wanted = 0.0, found = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 36; x < 40; ++x) {
      wanted += static_cast<double>(whole.prediction[1](x, y)) / 256;
      found += static_cast<double>(half.prediction[1](x, y)) / 256;
    }
  }
  EXPECT_NEAR(found, wanted, 0.1);
}

// Cells that the last frame needed are filled while counting, the others afterwards.
TEST(Correction, PlacingCellsEarlyDoesNotChangeTheBits) {
  const Extent extent{191, 107};
  Correction seasoned(extent, {}), fresh(extent, {});
  Scene left(extent);
  left.set_light(2.0f, 100);
  (void)left.run(seasoned);
  for (const int first_column : {0, 60, 150}) {
    Scene ahead(extent), after(extent);
    ahead.set_light(3.0f, first_column);
    after.set_light(3.0f, first_column);
    EXPECT_EQ(ahead.run(seasoned), after.run(fresh));
    EXPECT_TRUE(planes_equal(ahead.prediction, after.prediction));
    EXPECT_TRUE(planes_equal(ahead.innovation, after.innovation));
    fresh = Correction(extent, {});
  }
}

// Layers whose light changes elsewhere, of which one lacks the history of some pixels.
TEST(CellFilter, LayersGetTheBitsThatTheyGetAlone) {
  const Extent extent{600, 140};
  const auto make = [&](int layer) {
    Scene scene(extent);
    scene.set_light(2.0f + static_cast<float>(layer), 150 * layer);
    for (int x = 0; layer == 1 && x < 20; ++x) {
      for (int y = 60; y < 70; ++y) scene.innovation(400 + x, y) = std::nanf("");
    }
    return scene;
  };
  on_every_target([&] {
    std::array together{make(0), make(1), make(2)};
    std::array corrections{Correction(extent, {}), Correction(extent, {}), Correction(extent, {})};
    CellFilter filter(extent, {}, 3);
    std::vector<CorrectionLayer> layers;
    for (std::size_t i = 0; i < 3; ++i) {
      corrections[i].count_blocks(together[i].in(), {0, 0, extent.width, extent.height});
      corrections[i].prepare(together[i].in());
      layers.push_back({corrections[i], together[i].guides, together[i].innovation});
    }
    filter.correct(layers);
    for (std::size_t i = 0; i < 3; ++i) {
      Scene alone = make(static_cast<int>(i));
      Correction own(extent, {});
      EXPECT_EQ(corrections[i].share(), alone.run(own));
      EXPECT_GT(own.share(), 0.0);
      EXPECT_TRUE(planes_equal(corrections[i].correction(), own.correction())) << i;
      EXPECT_TRUE(planes_equal(together[i].innovation, alone.innovation)) << i;
    }
  });
}

TEST(Correction, ChangedBlocksAreCountedAgain) {
  const Extent extent{191, 107};
  Correction again(extent, {}), once(extent, {});
  Scene changed(extent), wanted(extent);
  for (Scene* scene : {&changed, &wanted}) scene->set_light(3.0f);
  (void)wanted.run(again);  // so that cells are filled ahead
  wanted.set_light(3.0f);
  for (const glm::ivec2 p : {glm::ivec2{5, 9}, {6, 9}, {70, 40}, {79, 47}, {190, 106}}) {
    changed.set_residual(p.x, p.y, 1e6f);
    wanted.set_residual(p.x, p.y, std::nanf(""));
  }
  again.count_blocks(changed.in(), {0, 0, extent.width, extent.height});
  for (const glm::ivec2 p : {glm::ivec2{5, 9}, {6, 9}, {70, 40}, {79, 47}, {190, 106}}) {
    changed.set_residual(p.x, p.y, std::nanf(""));
    const int x = p.x / 8 * 8, y = p.y / 8 * 8;
    again.count_blocks(changed.in(),
                       {x, y, std::min(x + 8, extent.width), std::min(y + 8, extent.height)});
  }
  EXPECT_EQ(changed.smooth(again), wanted.run(once));
  EXPECT_TRUE(planes_equal(changed.innovation, wanted.innovation));
}

TEST(Correction, ThreadCountDoesNotChangeTheBitsAtAnySize) {
  for (const Extent extent : kSweepExtents) {
    Scene one(extent), three(extent);
    one.set_light(2.0f);
    three.set_light(2.0f);
    set_thread_count(1);
    const double share = one.run();
    set_thread_count(3);
    EXPECT_EQ(three.run(), share);
    set_thread_count(0);
    EXPECT_TRUE(planes_equal(one.prediction, three.prediction));
    EXPECT_TRUE(planes_equal(one.innovation, three.innovation));
  }
}

TEST(CorrectionOptions, RejectsValuesOutOfRange) {
  const FloatTrapsOff nan_is_meant;
  const auto refused = [](const CorrectionOptions& options) {
    EXPECT_THROW(Correction({8, 8}, options), std::invalid_argument);
    EXPECT_THROW(CellFilter({8, 8}, options), std::invalid_argument);
  };
  refused({.significance = -1.0f});
  refused({.significance = std::nanf("")});
  refused({.passes = 0});
  refused({.passes = 7});
}

}  // namespace
}  // namespace eigenlight
