#include "sequences/compare/shared_source.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "sequences/runs/flythrough.h"
#include "sequences/runs/open_scene.h"
#include "temporal/methods.h"
#include "tests/support/compare.h"

namespace eigenlight {
namespace {

class SharedSourceTest : public testing::Test {
 protected:
  SharedSourceTest() {
    options_.extent = {48, 27};
    options_.spp = 2;
    options_.direct_spp = 1;
    animation_ = make_flythrough(scene_, Perturbation::kNone, options_.extent);
  }
  [[nodiscard]] LiveSource live() const { return {scene_, *animation_, options_, {0, 1, 2}}; }

  std::vector<std::string> notes_;
  Scene scene_ = open_scene({"cornell"}, notes_);
  RenderOptions options_;
  std::unique_ptr<Animation> animation_;
};

// Methods that ask for extra samples, beside one that does not.
TEST_F(SharedSourceTest, EveryMethodSeesTheBitsOfASourceOfItsOwn) {
  constexpr std::array<const char*, 3> kNames{"eigenlight", "chen2012", "mean"};
  LiveSource together = live();
  SharedSource shared(together);
  std::vector<std::unique_ptr<Denoiser>> among, alone;
  std::vector<std::unique_ptr<LiveSource>> sources;
  for (const char* name : kNames) {
    among.push_back(make_denoiser(name, {options_.extent}));
    alone.push_back(make_denoiser(name, {options_.extent}));
    sources.push_back(
        std::make_unique<LiveSource>(scene_, *animation_, options_, std::vector<int>{0, 1, 2}));
  }
  std::int64_t extra = 0;
  for (int frame = 0; frame < 3; ++frame) {
    ASSERT_TRUE(shared.render());
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const Planes<3>* a = among[i]->step(shared);
      const Planes<3>* b = alone[i]->step(*sources[i]);
      EXPECT_TRUE(planes_equal(*a, *b)) << kNames[i] << ", frame " << frame;
      EXPECT_EQ(among[i]->report().rays, alone[i]->report().rays) << kNames[i];
      extra += among[i]->report().extra_samples;
    }
  }
  EXPECT_GT(extra, 0) << "nobody asked for samples: the test shows nothing";
  EXPECT_FALSE(shared.render());
  Frame frame;
  EXPECT_FALSE(shared.next(frame));
}

TEST_F(SharedSourceTest, RewindingGivesTheSameFurtherSamples) {
  LiveSource source = live();
  Frame frame;
  ASSERT_TRUE(source.next(frame));
  Plane<std::uint8_t> extra(options_.extent);
  extra.fill(3);
  Planes<3> first, second, third;
  ASSERT_TRUE(resample(source, extra, frame, first));
  ASSERT_TRUE(resample(source, extra, frame, second));
  source.rewind_resampling();
  ASSERT_TRUE(resample(source, extra, frame, third));
  EXPECT_TRUE(planes_equal(first, third));
  EXPECT_FALSE(planes_equal(first, second));
}

TEST_F(SharedSourceTest, ACopiedFrameIsTheFrame) {
  LiveSource source = live();
  Frame frame, copy;
  ASSERT_TRUE(source.next(frame));
  ASSERT_TRUE(source.next(frame));
  copy_frame(frame, copy);
  EXPECT_EQ(copy.index, 1);
  EXPECT_EQ(copy.previous_index, 0);
  EXPECT_EQ(copy.spp, 2);
  EXPECT_EQ(copy.rays, frame.rays);
  EXPECT_EQ(copy.camera, frame.camera);
  EXPECT_TRUE(planes_equal(copy.surface.depth, frame.surface.depth));
  EXPECT_TRUE(planes_equal(copy.surface.normal, frame.surface.normal));
  EXPECT_TRUE(planes_equal(copy.surface.albedo, frame.surface.albedo));
  EXPECT_TRUE(planes_equal(copy.lights[0].radiance, frame.lights[0].radiance));
  EXPECT_TRUE(planes_equal(copy.motion, frame.motion));
  EXPECT_TRUE(planes_equal(copy.previous_depth, frame.previous_depth));
  EXPECT_TRUE(planes_equal(copy.direct, frame.direct));
  EXPECT_TRUE(planes_equal(copy.emission, frame.emission));
  EXPECT_TRUE(planes_equal(copy.position, frame.position));
  for (int y = 0; y < 27; ++y) {
    for (int x = 0; x < 48; ++x) ASSERT_EQ(copy.surface.id(x, y), frame.surface.id(x, y));
  }
}

}  // namespace
}  // namespace eigenlight
