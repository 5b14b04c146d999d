#include "sequences/files/exr_layers.h"

#include <gtest/gtest.h>

namespace eigenlight {
namespace {

TEST(ExrLayers, SplitsAtTheLastDot) {
  EXPECT_EQ(split_channel("ViewLayer.Denoising Albedo.R").layer, "ViewLayer.Denoising Albedo");
  EXPECT_EQ(split_channel("ViewLayer.Denoising Albedo.R").channel, "R");
  EXPECT_EQ(split_channel("G").layer, "");
  EXPECT_EQ(split_channel("G").channel, "G");
  EXPECT_EQ(split_channel("Z").layer, "Z");
  EXPECT_EQ(split_channel("Z").channel, "");
}

TEST(ExrLayers, ChannelOrderIsRgbaThenXyzw) {
  EXPECT_LT(channel_order("R"), channel_order("G"));
  EXPECT_LT(channel_order("B"), channel_order("A"));
  EXPECT_LT(channel_order("X"), channel_order("Y"));
  EXPECT_LT(channel_order("W"), channel_order("T"));
}

TEST(ExrLayers, ExactNameIsPreferred) {
  const std::vector<std::string> layers{"", "x.N", "N", "Normal"};
  EXPECT_EQ(find_layer(layers, "N"), "N");
  EXPECT_EQ(find_layer(layers, "color"), "");
  EXPECT_EQ(find_layer(layers, ""), "");
  EXPECT_EQ(find_layer(layers, "motion"), std::nullopt);
}

TEST(ExrLayers, NamesOfOtherRenderersAreFound) {
  const std::vector<std::string> cycles{
      "ViewLayer.Combined", "ViewLayer.Denoising Albedo", "ViewLayer.DiffCol", "ViewLayer.DiffInd",
      "ViewLayer.Normal",   "ViewLayer.Vector",           "ViewLayer.Depth"};
  EXPECT_EQ(find_layer(cycles, "color"), "ViewLayer.Combined");
  EXPECT_EQ(find_layer(cycles, "albedo"), "ViewLayer.DiffCol");
  EXPECT_EQ(find_layer(cycles, "indirect"), "ViewLayer.DiffInd");
  EXPECT_EQ(find_layer(cycles, "N"), "ViewLayer.Normal");
  EXPECT_EQ(find_layer(cycles, "motion"), "ViewLayer.Vector");
  EXPECT_EQ(find_layer(cycles, "Z"), "ViewLayer.Depth");
  const std::vector<std::string> arnold{"", "diffuse_albedo", "motionvector", "P"};
  EXPECT_EQ(find_layer(arnold, "albedo"), "diffuse_albedo");
  EXPECT_EQ(find_layer(arnold, "motion"), "motionvector");
  EXPECT_EQ(find_layer(arnold, "color"), "");
}

}  // namespace
}  // namespace eigenlight
