#include "sequences/compare/compare_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

CompareSettings settings_of(std::vector<std::string> scenes) {
  CompareSettings settings;
  settings.scenes = std::move(scenes);
  settings.size = "64x36";
  return settings;
}

std::vector<std::string> case_names(const CompareSettings& settings) {
  std::vector<std::string> names;
  for (const CompareCase& one : make_compare_plan(settings).cases) names.push_back(one.name);
  return names;
}

void expect_refused(const CompareSettings& settings, const std::string& message) {
  EXPECT_THAT([&] { (void)make_compare_plan(settings); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(message)));
}

TEST(ComparePlan, ScenesNameTheirOwnPerturbations) {
  CompareSettings settings = settings_of({"atrium:none,lights,objects", "cornell"});
  EXPECT_THAT(case_names(settings),
              ElementsAre("atrium", "atrium-lights", "atrium-objects", "cornell"));
  settings.perturb = "lights";
  EXPECT_THAT(case_names(settings),
              ElementsAre("atrium", "atrium-lights", "atrium-objects", "cornell-lights"));
  settings.scenes = {"atrium:step:12"};
  EXPECT_THAT(case_names(settings), ElementsAre("atrium-step-12"));
  expect_refused(settings_of({"atrium:"}), "scene 'atrium:': no perturbation");
  expect_refused(settings_of({"atrium:camera"}), "camera");
  expect_refused(settings_of({"atrium", "atrium:none"}), "a second one called 'atrium'");
}

TEST(ComparePlan, AFileMayHaveAColonInItsName) {
  const TempDir dir;
  const std::string file = dir / "a:lights.obj";
  std::ofstream(file) << "";
  const ComparePlan plan = make_compare_plan(settings_of({file}));
  ASSERT_EQ(plan.cases.size(), 1u);
  EXPECT_EQ(plan.cases[0].scene, file);
  EXPECT_EQ(plan.cases[0].perturb, "none");
}

TEST(ComparePlan, CropsAreRectanglesWithinThePicture) {
  CompareSettings settings = settings_of({"atrium"});
  EXPECT_FALSE(make_compare_plan(settings).crop);
  settings.crop = "16x12+48+24";
  settings.crops_per_row = 3;
  const CropPlan crop = *make_compare_plan(settings).crop;
  EXPECT_EQ(crop.x, 48);
  EXPECT_EQ(crop.y, 24);
  EXPECT_EQ(crop.size, (Extent{16, 12}));
  EXPECT_EQ(crop.per_row, 3);
  for (const char* text : {"16x12", "16x12+1", "16x12+-1+0", "x12+0+0"}) {
    settings.crop = text;
    expect_refused(settings, "expected WIDTHxHEIGHT+X+Y");
  }
  settings.crop = "16x12+49+24";
  expect_refused(settings, "reaches beyond the picture of 64x36");
}

TEST(ComparePlan, WaysOfAntialiasingAreContenders) {
  CompareSettings settings = settings_of({"atrium"});
  settings.antialias = "none,sraa,supersample:4";
  settings.spp = "8";
  settings.reference_spp = 64;
  const ComparePlan plan = make_compare_plan(settings);
  EXPECT_TRUE(plan.is_antialiasing());
  ASSERT_EQ(plan.contenders.size(), 3u);
  EXPECT_EQ(plan.contenders[2].label, "supersample-4");
  EXPECT_EQ(plan.baseline(), &plan.contenders[0]);
  EXPECT_EQ(&plan.ours(), &plan.contenders[0]);
  settings.spp = "8,16";
  expect_refused(settings, "spp: 2 numbers, expected one with --aa");
  settings.spp = "8";
  settings.reference_spp = 48;
  expect_refused(settings, "reference-spp 48: expected a multiple of 32");
  settings.antialias = "blur";
  expect_refused(settings, "blur");
}

TEST(ComparePlan, WholePicturesAreMeasuredWhereDirectLightIsAtHand) {
  CompareSettings settings = settings_of({"atrium"});
  EXPECT_FALSE(make_compare_plan(settings).is_whole);
  settings.layer = "color";
  settings.methods = "eigenlight,noisy";
  EXPECT_TRUE(make_compare_plan(settings).is_whole);
  EXPECT_THAT(make_compare_plan(settings).measured_light(), HasSubstr("the whole picture"));
  settings.methods = "eigenlight,meyer2006";
  expect_refused(settings, "method 'meyer2006' reads ahead");
  settings.layer = "direct";
  expect_refused(settings, "layer 'direct': expected indirect or color");
}

TEST(ComparePlan, TheBaselineIsTheNoisyInput) {
  CompareSettings settings = settings_of({"atrium"});
  settings.methods = "mean,noisy";
  const ComparePlan plan = make_compare_plan(settings);
  ASSERT_TRUE(plan.baseline());
  EXPECT_EQ(plan.baseline()->label, "noisy");
  settings.methods = "mean";
  EXPECT_FALSE(make_compare_plan(settings).baseline());
}

}  // namespace
}  // namespace eigenlight
