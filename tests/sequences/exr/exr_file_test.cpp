#include "sequences/exr/exr_file.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTimeCodeAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numeric>

#include "frame/bad_file.h"
#include "sequences/exr/exr_rewrite.h"
#include "sequences/exr/exr_write.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/exr_maker.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Imath::Box2i kDisplay(Imath::V2i(0, 0), Imath::V2i(39, 29));

int index_of(const ExrFile& file, const std::string& full_name) {
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    if (file.channels()[i].full_name == full_name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no channel " << full_name;
  return 0;
}

// The bits of a channel as OpenEXR's own class for old files reads them.
std::vector<std::uint16_t> half_bits(const std::filesystem::path& path, const char* channel) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  std::vector<std::uint16_t> bits(static_cast<std::size_t>(window.max.x - window.min.x + 1) *
                                  static_cast<std::size_t>(window.max.y - window.min.y + 1));
  Imf::FrameBuffer frame;
  frame.insert(channel, Imf::Slice::Make(Imf::HALF, bits.data(), window));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return bits;
}

void expect_same(const Plane<float>& plane, const std::vector<std::uint16_t>& bits) {
  for (int y = 0; y < plane.height(); ++y) {
    for (int x = 0; x < plane.width(); ++x) {
      const std::size_t i = static_cast<std::size_t>(y * plane.width() + x);
      const float wanted = Imath::half(Imath::half::FromBits, bits[i]);
      if (std::isnan(wanted)) {
        ASSERT_TRUE(std::isnan(plane(x, y)));
      } else {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(plane(x, y)), std::bit_cast<std::uint32_t>(wanted))
            << x << " " << y;
      }
    }
  }
}

TEST(ExrFile, NamesPartsChannelsAndViews) {
  const TempDir dir;
  std::vector<Imf::Header> headers;
  const auto add = [&](const char* name, const char* view, std::vector<const char*> channels) {
    headers.push_back(exr_header(kDisplay, kDisplay, Imf::ZIP_COMPRESSION));
    headers.back().setName(name);
    headers.back().setType(Imf::SCANLINEIMAGE);
    if (*view) headers.back().setView(view);
    for (const char* c : channels) headers.back().channels().insert(c, Imf::Channel(Imf::HALF));
  };
  add("rgba_main", "", {"R"});
  add("albedo", "", {"albedo.R"});
  add("Z", "", {"Z"});
  add("rgba.left", "left", {"R", "forward.u"});
  add("character.left", "left", {"character.R"});
  ExrMaker::write(dir / "parts.exr", headers);

  const ExrFile file(dir / "parts.exr");
  ASSERT_EQ(file.parts().size(), 5u);
  EXPECT_EQ(file.parts()[3].name, "rgba.left");
  EXPECT_EQ(file.parts()[3].view, "left");
  EXPECT_EQ(file.parts()[3].compression, "zip");
  std::vector<std::string> names, layers, views;
  for (const ExrChannelInfo& c : file.channels()) {
    names.push_back(c.full_name);
    layers.push_back(c.layer + "|" + c.channel);
    views.push_back(c.view);
  }
  EXPECT_THAT(names, ElementsAre("rgba_main.R", "albedo.R", "Z", "rgba.left.R",
                                 "rgba.left.forward.u", "character.left.character.R"));
  EXPECT_THAT(layers, ElementsAre("rgba_main|R", "albedo|R", "Z|", "rgba|R", "rgba.forward|u",
                                  "character|R"));
  EXPECT_THAT(views, ElementsAre("", "", "", "left", "left", "left"));
}

TEST(ExrFile, FindsViewsInTheNamesOfOnePart) {
  const TempDir dir;
  Imf::Header header = exr_header(kDisplay, kDisplay, Imf::PIZ_COMPRESSION);
  for (const char* c : {"R", "left.R", "diffuse.left.R", "disparityL.x"}) {
    header.channels().insert(c, Imf::Channel(Imf::HALF));
  }
  Imf::addMultiView(header, {"right", "left"});
  header.setName("one part keeps its names");
  ExrMaker::write(dir / "views.exr", header);
  std::vector<std::string> found;
  const ExrFile file(dir / "views.exr");
  for (const ExrChannelInfo& c : file.channels()) {
    found.push_back(c.full_name + "|" + c.layer + "|" + c.channel + "|" + c.view);
  }
  EXPECT_THAT(found, ElementsAre("R||R|right", "diffuse.left.R|diffuse|R|left",
                                 "disparityL.x|disparityL|x|", "left.R||R|left"));
}

TEST(ExrFile, ReadsDataWindowsWhereverTheyAre) {
  const TempDir dir;
  const std::pair<Imath::V2i, Imath::V2i> windows[] = {{{3, 5}, {20, 19}},
                                                       {{-7, -4}, {50, 33}},
                                                       {{1000, 0}, {1011, 8}},
                                                       {{-300, -200}, {-299, -180}}};
  for (const auto& [min, max] : windows) {
    Imf::Header header = exr_header(kDisplay, {min, max}, Imf::ZIP_COMPRESSION);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    ExrMaker::write(dir / "window.exr", header);
    const ExrFile file(dir / "window.exr");
    EXPECT_EQ(file.display_window(), (ExrWindow{0, 0, 40, 30}));
    const ExrWindow wanted{min.x, min.y, max.x - min.x + 1, max.y - min.y + 1};
    EXPECT_EQ(file.parts()[0].data, wanted);
    const std::vector<Plane<float>> planes = file.read(std::array{0});
    ASSERT_EQ(planes[0].extent(), (Extent{wanted.width, wanted.height}));
    expect_same(planes[0], half_bits(dir / "window.exr", "Y"));
  }
}

TEST(ExrFile, ReadsTilesAndTheirBaseLevel) {
  const TempDir dir;
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    Imf::Header header =
        exr_header(kDisplay, {{-5, 2}, {51, 40}}, Imf::ZIPS_COMPRESSION, Imf::RANDOM_Y);
    header.setTileDescription(Imf::TileDescription(16, 8, mode, Imf::ROUND_UP));
    header.channels().insert("albedo.R", Imf::Channel(Imf::HALF));
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    ExrMaker::write(dir / "tiles.exr", header);
    const ExrFile file(dir / "tiles.exr");
    EXPECT_TRUE(file.parts()[0].is_tiled);
    // 57 x 39 rounded up: 57 29 15 8 4 2 1 and 39 20 10 5 3 2 1.
    EXPECT_EQ(file.parts()[0].levels, mode == Imf::ONE_LEVEL       ? 1
                                      : mode == Imf::MIPMAP_LEVELS ? 7
                                                                   : 49);
    expect_same(file.read(std::array{0})[0], half_bits(dir / "tiles.exr", "albedo.R"));
    EXPECT_EQ(file.read_uint(1).extent(), (Extent{57, 39}));
  }
}

TEST(ExrFile, RefusesWhatIsNotFlatLightByName) {
  const TempDir dir;
  Imf::Header header = exr_header(kDisplay, kDisplay, Imf::NO_COMPRESSION);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  ExrMaker::write(dir / "a.exr", header);
  const ExrFile file(dir / "a.exr");
  EXPECT_EQ(file.channels()[0].x_sampling, 2);
  const auto read = [&](const char* name) { return file.read(std::array{index_of(file, name)}); };
  EXPECT_THAT([&] { read("BY"); },
              ThrowsMessage<BadFile>(HasSubstr("a.exr: channel 'BY' is subsampled 2x2")));
  EXPECT_THAT([&] { read("id"); },
              ThrowsMessage<BadFile>(HasSubstr("a.exr: channel 'id' holds integers")));
  EXPECT_THAT([&] { (void)file.read_uint(index_of(file, "Y")); },
              ThrowsMessage<BadFile>(HasSubstr("a.exr: channel 'Y' is not of type uint")));
  EXPECT_NO_THROW(read("Y"));

  Imf::Header deep = exr_header(kDisplay, kDisplay, Imf::ZIPS_COMPRESSION);
  deep.setType(Imf::DEEPSCANLINE);
  deep.setName("deep");
  deep.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  ExrMaker::write(dir / "deep.exr", std::vector<Imf::Header>{deep});
  const ExrFile deep_file(dir / "deep.exr");
  EXPECT_TRUE(deep_file.parts()[0].is_deep);
  EXPECT_THAT([&] { (void)deep_file.read(std::array{0}); },
              ThrowsMessage<BadFile>(HasSubstr("deep.exr: deep data, expected flat pixels")));
}

TEST(ExrFile, ReadsAttributesOfEachType) {
  const TempDir dir;
  Imf::Header header = exr_header(kDisplay, kDisplay, Imf::ZIP_COMPRESSION);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.insert("an int", Imf::IntAttribute(-7));
  header.insert("a float", Imf::FloatAttribute(0.1f));
  header.insert("a double", Imf::DoubleAttribute(0.1));
  header.insert("a string", Imf::StringAttribute("x y"));
  Imath::M44f matrix;
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = static_cast<float>(i);
  header.insert("worldToCamera", Imf::M44fAttribute(matrix));
  header.insert("a v2f", Imf::V2fAttribute(Imath::V2f(1, 2)));
  header.insert("a v3f", Imf::V3fAttribute(Imath::V3f(1, 2, 3)));
  header.insert("a time", Imf::TimeCodeAttribute(Imf::TimeCode(1, 2)));
  Imf::addChromaticities(header, Imf::Chromaticities());
  ExrMaker::write(dir / "a.exr", header);
  const ExrFile file(dir / "a.exr");
  EXPECT_EQ(file.attribute("an int"), ExrValue(-7));
  EXPECT_EQ(file.attribute("a float"), ExrValue(0.1f));
  EXPECT_EQ(file.attribute("a double"), ExrValue(0.1));
  EXPECT_EQ(file.attribute("a string"), ExrValue(std::string("x y")));
  ExrMatrix wanted;
  std::iota(wanted.begin(), wanted.end(), 0.0f);
  EXPECT_EQ(file.attribute("worldToCamera"), ExrValue(wanted));
  EXPECT_EQ(file.attribute("a v2f"), ExrValue(std::array<float, 2>{1, 2}));
  EXPECT_EQ(file.attribute("a v3f"), ExrValue(std::array<float, 3>{1, 2, 3}));
  const Imf::Chromaticities rec709;
  const auto found = std::get<ExrChromaticities>(*file.attribute("chromaticities"));
  EXPECT_EQ(found.green, (std::array{rec709.green.x, rec709.green.y}));
  EXPECT_EQ(found.white, (std::array{rec709.white.x, rec709.white.y}));
  EXPECT_FALSE(file.attribute("a time"));
  EXPECT_FALSE(file.attribute("nothing"));
  EXPECT_THAT(file.attribute_names(), testing::Contains("a time"));
}

TEST(ExrFile, HugeDisplayWindowsAreNoReasonToAllocate) {
  const TempDir dir;
  Imf::Header header = exr_header({{0, 0}, {99999, 99999}}, kDisplay, Imf::ZIP_COMPRESSION);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  ExrMaker::write(dir / "a.exr", header);
  const ExrFile file(dir / "a.exr");
  EXPECT_EQ(file.display_window().width, 100000);
  EXPECT_EQ(file.read(std::array{0})[0].extent(), (Extent{40, 30}));
}

// Whatever happens to a file, reading and copying it ends well or with one line that names it.
void expect_clean(const std::filesystem::path& path, const std::filesystem::path& out) {
  try {
    const ExrFile file(path);
    rewrite_exr(file, out, {});
    for (int i = 0; i < static_cast<int>(file.channels().size()); ++i)
      (void)file.read(std::array{i});
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(ExrFile, DamagedFilesAreRefusedInOneLine) {
  const TempDir dir;
  std::vector<Imf::Header> headers;
  for (const char* name : {"lines", "tiles"}) {
    headers.push_back(exr_header(kDisplay, kDisplay, Imf::ZIP_COMPRESSION));
    headers.back().setName(name);
    headers.back().setType(headers.size() == 1 ? Imf::SCANLINEIMAGE : Imf::TILEDIMAGE);
    headers.back().channels().insert("R", Imf::Channel(Imf::HALF));
  }
  headers[1].setTileDescription(Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS));
  ExrMaker::write(dir / "whole.exr", headers);
  const std::string whole = read_whole_file(dir / "whole.exr");
  std::mt19937 random(7);
  int refused = 0;
  for (std::size_t i = 0; i < 600; ++i) {
    // Cut off at each byte of the headers and here and there behind them; then bytes changed.
    std::string bytes = whole;
    if (i < 300) {
      bytes.resize(i < 250 ? i * 3 : whole.size() * (i - 249) / 51);
    } else {
      for (int k = 0; k < 3; ++k)
        bytes[random() % (i < 450 ? 700 : whole.size())] = static_cast<char>(random());
    }
    write_file_atomically(dir / "damaged.exr", bytes);
    expect_clean(dir / "damaged.exr", dir / "out.exr");
    try {
      (void)ExrFile(dir / "damaged.exr");
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 250);
}

}  // namespace
}  // namespace eigenlight
