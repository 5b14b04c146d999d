#include "sequences/layers/layer_list.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/exr_maker.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;

const Imath::Box2i kWindow(Imath::V2i(0, 0), Imath::V2i(7, 3));

Imf::Header part(const std::string& name, const std::vector<std::string>& channels,
                 const std::string& view = {}) {
  Imf::Header header = exr_header(kWindow, kWindow, Imf::ZIP_COMPRESSION);
  if (!name.empty()) header.setName(name);
  if (!name.empty()) header.setType(Imf::SCANLINEIMAGE);
  if (!view.empty()) header.setView(view);
  for (const std::string& channel : channels) {
    header.channels().insert(channel, Imf::Channel(Imf::HALF));
  }
  return header;
}

std::vector<FileLayer> layers_of(const std::vector<Imf::Header>& parts) {
  const TempDir dir;
  if (parts.size() == 1) {
    ExrMaker::write(dir / "a.exr", parts.front());
  } else {
    ExrMaker::write(dir / "a.exr", parts);
  }
  return list_layers(ExrFile(dir / "a.exr"), 0);
}

std::vector<std::string> names_of(const std::vector<FileLayer>& layers) {
  std::vector<std::string> names;
  for (const FileLayer& layer : layers) {
    names.push_back((layer.view.empty() ? "" : layer.view + ":") + layer.name + ' ' +
                    std::to_string(layer.size()));
  }
  return names;
}

TEST(LayerList, ChannelsOfOneNameAreALayerInTheirOrder) {
  const auto layers = layers_of({part("", {"R", "G", "B", "A", "Z", "dif.red", "dif.green",
                                           "dif.blue", "N.x", "N.y", "N.z", "mv.u", "mv.v"})});
  EXPECT_THAT(names_of(layers), testing::UnorderedElementsAre(" 4", "Z 1", "dif 3", "N 3", "mv 2"));
  for (const FileLayer& layer : layers) {
    if (layer.name == "dif") {
      EXPECT_THAT(layer.channels, ElementsAre("dif.red", "dif.green", "dif.blue"));
    }
    if (layer.name.empty()) {
      EXPECT_THAT(layer.channels, ElementsAre("R", "G", "B", "A"));
    }
  }
}

TEST(LayerList, DepthBesideAColorIsALayerOfItsOwn) {
  EXPECT_THAT(names_of(layers_of({part("", {"fg.R", "fg.G", "fg.B", "fg.Z"})})),
              testing::UnorderedElementsAre("fg 3", "fg.Z 1"));
}

TEST(LayerList, PartsNameTheirLayers) {
  EXPECT_THAT(names_of(layers_of({part("rgba", {"R", "G", "B"}), part("depth", {"Z"}),
                                  part("albedo", {"R", "G", "B"})})),
              testing::UnorderedElementsAre("rgba 3", "depth 1", "albedo 3"));
}

TEST(LayerList, LettersOfOneColorMayLieInSeveralParts) {
  EXPECT_THAT(names_of(layers_of({part("part0", {"R"}), part("part1", {"G"}),
                                  part("part2", {"B", "layer.R"}), part("part3", {"layer.G"}),
                                  part("part4", {"layer.B"})})),
              testing::UnorderedElementsAre(" 3", "layer 3"));
}

TEST(LayerList, ViewsAreToldApart) {
  EXPECT_THAT(names_of(layers_of({part("rgba.left", {"R", "G", "B"}, "left"),
                                  part("rgba.right", {"R", "G", "B"}, "right")})),
              testing::UnorderedElementsAre("left:rgba 3", "right:rgba 3"));
}

}  // namespace
}  // namespace eigenlight
