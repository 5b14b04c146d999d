// Every way to store pixels: what is not replaced keeps its bits.
#include <OpenEXR/ImfTiledInputFile.h>
#include <fmt/format.h>

#include <map>

#include "sequences/exr/exr_rewrite.h"
#include "tests/support/exr_rewriting.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::IsEmpty;

struct Kind {
  const char* name;
  Imf::Compression compression;
  Imf::LineOrder order = Imf::INCREASING_Y;
  bool is_tiled = false;
  Imf::LevelMode levels = Imf::ONE_LEVEL;
};

// Bytes of "channel lx ly" as OpenEXR's class for old files decodes them.
std::map<std::string, std::string> all_levels(const std::filesystem::path& path) {
  Imf::TiledInputFile file(path.c_str());
  std::map<std::string, std::string> found;
  for (int ly = 0; ly < file.numYLevels(); ++ly) {
    for (int lx = 0; lx < file.numXLevels(); ++lx) {
      if (!file.isValidLevel(lx, ly)) continue;
      Imf::FrameBuffer frame;
      const Imf::ChannelList& channels = file.header().channels();
      for (auto c = channels.begin(); c != channels.end(); ++c) {
        std::string& bytes = found[fmt::format("{} {} {}", c.name(), lx, ly)];
        bytes.resize(static_cast<std::size_t>(file.levelWidth(lx)) *
                     static_cast<std::size_t>(file.levelHeight(ly)) *
                     (c.channel().type == Imf::HALF ? 2 : 4));
        frame.insert(c.name(), Imf::Slice::Make(c.channel().type, bytes.data(),
                                                file.dataWindowForLevel(lx, ly)));
      }
      file.setFrameBuffer(frame);
      file.readTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
    }
  }
  return found;
}

// All levels of the channels that keep their pixels.
std::map<std::string, std::string> passenger_levels(const std::filesystem::path& path) {
  auto levels = all_levels(path);
  std::erase_if(levels, [](const auto& entry) {
    return entry.first.starts_with("albedo.R ") || entry.first.starts_with("Z ");
  });
  return levels;
}

class EachKind : public testing::TestWithParam<Kind> {};

void expect_equal_planes(const Plane<float>& found, const Plane<float>& wanted) {
  for (int y = 0; y < wanted.height(); ++y) {
    for (int x = 0; x < wanted.width(); ++x) ASSERT_EQ(found(x, y), wanted(x, y));
  }
}

TEST_P(EachKind, OnlyTheChosenChannelChanges) {
  const Kind& kind = GetParam();
  const TempDir dir;
  Imf::Header header = mixed_header(kind.compression, kind.order);
  if (kind.is_tiled) {
    header.setTileDescription(Imf::TileDescription(32, 16, kind.levels, Imf::ROUND_DOWN));
  } else {
    header.channels().insert("Y", Imf::Channel(Imf::HALF, 1, 2));
  }
  ExrMaker::write(dir / "in.exr", header);
  const ExrFile file(dir / "in.exr");
  const int light = index_of(file, "albedo.R"), depth = index_of(file, "Z");
  const Plane<float> pixels = new_pixels(file, light), depths = new_pixels(file, depth);

  rewrite_exr(file, dir / "copy.exr", {});
  EXPECT_TRUE(read_whole_file(dir / "copy.exr") == read_whole_file(dir / "in.exr"));

  const ExrReplacement replacements[] = {{light, &pixels}, {depth, &depths}};
  const ExrRewriteReport report = rewrite_exr(file, dir / "out.exr", replacements);
  EXPECT_THAT(report.recompressed, IsEmpty());
  EXPECT_EQ(report.levels.empty(), kind.levels == Imf::ONE_LEVEL);
  EXPECT_EQ(report.values.clamped, 0);
  if (kind.is_tiled) {
    EXPECT_TRUE(passenger_levels(dir / "in.exr") == passenger_levels(dir / "out.exr"));
  }
  // The core of OpenEXR 3.1 cannot find the tiles of rip maps.
  if (kind.levels != Imf::RIPMAP_LEVELS) {
    expect_equal_but(dir / "in.exr", dir / "out.exr", {"0 albedo.R", "0 Z"});
  }
  if (!kind.is_tiled) {
    const CoreFile out = CoreReader::read((dir / "out.exr").string());
    EXPECT_TRUE(out.parts[0].values.at("albedo.R 0 0") == half_bytes(pixels));
  }
  const ExrFile again(dir / "out.exr");
  const std::vector<Plane<float>> read = again.read(std::array{light, depth});
  expect_equal_planes(read[0], pixels);
  expect_equal_planes(read[1], depths);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EachKind,
    testing::Values(Kind{"None", Imf::NO_COMPRESSION}, Kind{"Rle", Imf::RLE_COMPRESSION},
                    Kind{"Zips", Imf::ZIPS_COMPRESSION}, Kind{"Zip", Imf::ZIP_COMPRESSION},
                    Kind{"Piz", Imf::PIZ_COMPRESSION},
                    Kind{"FromTheBottom", Imf::PIZ_COMPRESSION, Imf::DECREASING_Y},
                    Kind{"Tiles", Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, true},
                    Kind{"TilesFromTheBottom", Imf::ZIP_COMPRESSION, Imf::DECREASING_Y, true},
                    Kind{"TilesInAnyOrder", Imf::PIZ_COMPRESSION, Imf::RANDOM_Y, true},
                    Kind{"MipMap", Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, true,
                         Imf::MIPMAP_LEVELS},
                    Kind{"RipMap", Imf::ZIPS_COMPRESSION, Imf::RANDOM_Y, true, Imf::RIPMAP_LEVELS}),
    [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace eigenlight
