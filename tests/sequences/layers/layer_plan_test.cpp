#include "sequences/layers/layer_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

FileLayer layer(const std::string& name, const std::vector<std::string>& suffixes) {
  FileLayer made;
  made.name = name;
  for (const std::string& suffix : suffixes) {
    made.channels.push_back(name.empty() ? suffix : name + '.' + suffix);
  }
  if (suffixes.empty()) made.channels.push_back(name);
  return made;
}
FileLayer color(const std::string& name) { return layer(name, {"R", "G", "B"}); }

std::vector<FileLayer> cycles() {
  std::vector<FileLayer> layers{layer("My.View Layer.Combined", {"R", "G", "B", "A"})};
  for (const char* pass :
       {"DiffDir", "DiffInd", "DiffCol", "GlossDir", "GlossInd", "GlossCol", "Emit", "Env"}) {
    layers.push_back(color(std::string("My.View Layer.") + pass));
  }
  layers.push_back(layer("My.View Layer.Normal", {"X", "Y", "Z"}));
  layers.push_back(layer("My.View Layer.Depth", {"Z"}));
  layers.push_back(layer("My.View Layer.Vector", {"X", "Y", "Z", "W"}));
  return layers;
}

const PlanRow& row_of(const LayerPlan& plan, const std::string& name) {
  return *std::find_if(plan.rows.begin(), plan.rows.end(),
                       [&](const PlanRow& row) { return row.layer == name; });
}

std::vector<std::string> names_of_lights(const ViewPlan& view) {
  std::vector<std::string> names;
  for (const PlannedLight& light : view.lights) {
    names.push_back(light.layer->name + (light.color ? " over " + light.color->name : "") +
                    (light.is_divided ? ", divided" : ""));
  }
  return names;
}

TEST(LayerPlan, CyclesPassesAreFoundBehindAViewLayerWithADotInItsName) {
  const LayerPlan plan = plan_layers(cycles(), {});
  ASSERT_EQ(plan.views.size(), 1u);
  const ViewPlan& view = plan.views[0];
  EXPECT_THAT(names_of_lights(view),
              ElementsAre("My.View Layer.DiffDir over My.View Layer.DiffCol, divided",
                          "My.View Layer.DiffInd over My.View Layer.DiffCol, divided",
                          "My.View Layer.GlossDir over My.View Layer.GlossCol, divided",
                          "My.View Layer.GlossInd over My.View Layer.GlossCol, divided"));
  ASSERT_EQ(view.sums.size(), 1u);
  EXPECT_THAT(view.sums[0].lights, ElementsAre(0u, 1u, 2u, 3u));
  EXPECT_EQ(view.emission.size(), 2u);
  EXPECT_EQ(view.albedo->name, "My.View Layer.DiffCol");
  EXPECT_EQ(view.depth->name, "My.View Layer.Depth");
  EXPECT_EQ(view.motion->size(), 4u);
  EXPECT_EQ(row_of(plan, "My.View Layer.Combined").use, "composed");
  EXPECT_EQ(row_of(plan, "My.View Layer.DiffCol").use, "guide");
}

TEST(LayerPlan, ArnoldSumsAreComposedOfDirectAndIndirectLight) {
  const LayerPlan plan = plan_layers(
      {color(""), color("diffuse"), color("diffuse_direct"), color("diffuse_indirect"),
       color("specular"), color("diffuse_albedo"), layer("N", {"X", "Y", "Z"}), layer("Z", {})},
      {});
  const ViewPlan& view = plan.views.at(0);
  EXPECT_THAT(names_of_lights(view),
              ElementsAre("diffuse_direct over diffuse_albedo",
                          "diffuse_indirect over diffuse_albedo", "specular over diffuse_albedo"));
  ASSERT_EQ(view.sums.size(), 2u);
  EXPECT_EQ(view.sums[0].layer.name, "diffuse");
  EXPECT_THAT(view.sums[0].lights, ElementsAre(0u, 1u));
  EXPECT_THAT(view.sums[1].lights, ElementsAre(0u, 1u, 2u));
}

TEST(LayerPlan, DiffuseOfVRayIsAColor) {
  const LayerPlan plan = plan_layers(
      {color(""), color("GI"), color("lighting"), color("diffuse"), color("reflect")}, {});
  EXPECT_THAT(names_of_lights(plan.views.at(0)),
              ElementsAre("GI over diffuse", "lighting over diffuse", "reflect"));
}

TEST(LayerPlan, BeautyAloneIsOneLayer) {
  const LayerPlan plan = plan_layers({color(""), color("albedo")}, {});
  const ViewPlan& view = plan.views.at(0);
  EXPECT_THAT(names_of_lights(view), ElementsAre(" over albedo"));
  EXPECT_TRUE(view.sums.empty());
  EXPECT_EQ(row_of(plan, "color").use, "denoised");
}

TEST(LayerPlan, MapOverridesNames) {
  const LayerPlan plan = plan_layers(
      {color(""), color("key"), color("fill"), color("albedo"), color("tex"), color("direct")},
      {.map = {"light=key", "light=fill", "albedo=tex"}});
  EXPECT_THAT(names_of_lights(plan.views.at(0)),
              ElementsAre("key over albedo", "fill over albedo"));
  EXPECT_EQ(plan.views.at(0).albedo->name, "tex");
  EXPECT_EQ(row_of(plan, "direct").use, "copied");
}

TEST(LayerPlan, KeptAndSkippedLayersAreCopied) {
  const LayerPlan plan = plan_layers(cycles(), {.keep = "GlossInd", .skip = "normal|GlossDir"});
  EXPECT_EQ(plan.views.at(0).lights.size(), 2u);
  EXPECT_FALSE(plan.views.at(0).normal);
  EXPECT_EQ(row_of(plan, "My.View Layer.GlossInd").why, "--keep");
  EXPECT_EQ(row_of(plan, "My.View Layer.GlossDir").why, "--skip");
}

TEST(LayerPlan, LayersThatCannotBeUsedDoNotStopARun) {
  FileLayer id = layer("id", {}), depth = layer("depth", {});
  id.type = ExrType::kHalf;
  depth.type = ExrType::kUint;
  FileLayer deep = color("direct");
  deep.is_deep = true;
  const LayerPlan plan = plan_layers({color(""), id, depth, deep}, {});
  EXPECT_FALSE(plan.views.at(0).depth);
  EXPECT_EQ(row_of(plan, "depth").use, "copied");
  EXPECT_THAT(row_of(plan, "direct").why, HasSubstr("deep"));
}

TEST(LayerPlan, UnusableLayersMakeWayForTheNextName) {
  FileLayer depth = layer("depth", {}), albedo = color("albedo"), emission = color("emission");
  depth.type = ExrType::kUint;
  albedo.is_subsampled = true;
  emission.is_deep = true;
  const LayerPlan plan = plan_layers({color(""), depth, layer("Z", {}), albedo, color("basecolor"),
                                      emission, color("direct"), layer("sheen", {})},
                                     {});
  const ViewPlan& view = plan.views.at(0);
  EXPECT_EQ(view.depth->name, "Z");
  EXPECT_EQ(view.albedo->name, "basecolor");
  EXPECT_TRUE(view.emission.empty());
  EXPECT_THAT(names_of_lights(view), ElementsAre("direct over basecolor"));
  EXPECT_EQ(row_of(plan, "depth").why, "integers, expected half or float");
  EXPECT_EQ(row_of(plan, "sheen").why, "1 channels, expected 3");
  EXPECT_THAT(
      [&] {
        (void)plan_layers({color(""), depth}, {.map = {"depth=depth"}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("--map depth=depth: integers")));
}

TEST(LayerPlan, DirectLightIsToldByTheTableOfNames) {
  const LayerPlan plan = plan_layers(cycles(), {});
  std::vector<bool> direct;
  for (const PlannedLight& light : plan.views.at(0).lights) direct.push_back(light.is_direct);
  EXPECT_THAT(direct, ElementsAre(true, false, true, false));
  EXPECT_TRUE(plan_layers({color("")}, {}).views.at(0).lights.at(0).is_direct);
}

TEST(LayerPlan, EachViewHasItsOwnPlan) {
  FileLayer left = color(""), right = color("");
  left.view = "left";
  right.view = "right";
  const LayerPlan plan = plan_layers({left, right}, {});
  ASSERT_EQ(plan.views.size(), 2u);
  EXPECT_EQ(plan.views[1].lights.at(0).layer->view, "right");
}

TEST(LayerPlan, WhatIsWrongIsNamed) {
  EXPECT_THAT([] { (void)plan_layers({color("")}, {.map = {"albedo"}}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected ROLE=LAYER")));
  EXPECT_THAT([] { (void)plan_layers({color("")}, {.map = {"shine=x"}}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("unknown role 'shine'")));
  EXPECT_THAT([] { (void)plan_layers({color("")}, {.map = {"albedo=x"}}); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("--map albedo=x: no such layer; the files have: color")));
  EXPECT_THAT([] { (void)plan_layers({color("")}, {.keep = "("}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("--keep '('")));
  EXPECT_THAT([] { (void)plan_layers({layer("Z", {})}, {}); },
              ThrowsMessage<BadFile>(HasSubstr("no layer of light found")));
}

}  // namespace
}  // namespace eigenlight
