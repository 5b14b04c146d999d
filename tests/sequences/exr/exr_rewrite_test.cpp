#include "sequences/exr/exr_rewrite.h"

#include <OpenEXR/ImfInputFile.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>

#include "frame/bad_file.h"
#include "frame/tiles.h"
#include "tests/support/exr_rewriting.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

// Values of the untouched channel as OpenEXR's class for old files decodes them.
std::string decoded(const std::filesystem::path& path, const char* channel, Imf::PixelType type) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  std::string bytes(static_cast<std::size_t>(window.max.x - window.min.x + 1) *
                        static_cast<std::size_t>(window.max.y - window.min.y + 1) *
                        (type == Imf::HALF ? 2 : 4),
                    '\0');
  Imf::FrameBuffer frame;
  frame.insert(channel, Imf::Slice::Make(type, bytes.data(), window));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return bytes;
}

TEST(ExrRewrite, LossyCompressionBecomesZip) {
  const std::pair<Imf::Compression, const char*> kinds[] = {
      {Imf::DWAA_COMPRESSION, "DWAA becomes ZIP"},
      {Imf::DWAB_COMPRESSION, "DWAB becomes ZIP"},
      {Imf::B44_COMPRESSION, "B44 becomes ZIP"},
      {Imf::B44A_COMPRESSION, "B44A becomes ZIP"},
      {Imf::PXR24_COMPRESSION, "PXR24 becomes ZIP"}};
  for (const auto& [compression, words] : kinds) {
    const TempDir dir;
    ExrMaker::write(dir / "in.exr", mixed_header(compression, Imf::INCREASING_Y));
    const ExrFile file(dir / "in.exr");
    const int light = index_of(file, "albedo.R");
    const Plane<float> pixels = new_pixels(file, light);
    const ExrReplacement replacement[] = {{light, &pixels}};
    EXPECT_THAT(rewrite_exr(file, dir / "out.exr", replacement).recompressed, ElementsAre(words));
    EXPECT_EQ(ExrFile(dir / "out.exr").parts()[0].compression, "zip");
    const CorePart out = CoreReader::read((dir / "out.exr").string()).parts[0];
    EXPECT_TRUE(out.values.at("albedo.R 0 0") == half_bytes(pixels));
    EXPECT_TRUE(out.values.at("R 0 0") == decoded(dir / "in.exr", "R", Imf::HALF)) << words;
    EXPECT_TRUE(out.values.at("Z 0 0") == decoded(dir / "in.exr", "Z", Imf::FLOAT)) << words;
    // Without new pixels nothing is decoded.
    EXPECT_THAT(rewrite_exr(file, dir / "copy.exr", {}).recompressed, IsEmpty());
    EXPECT_TRUE(read_whole_file(dir / "copy.exr") == read_whole_file(dir / "in.exr"));
  }
}

TEST(ExrRewrite, Pxr24OfHalvesStays) {
  const TempDir dir;
  Imf::Header header = exr_header(kDisplay, kBeyond, Imf::PXR24_COMPRESSION);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  ExrMaker::write(dir / "in.exr", header);
  const ExrFile file(dir / "in.exr");
  const Plane<float> pixels = new_pixels(file, 0);
  const ExrReplacement replacement[] = {{0, &pixels}};
  EXPECT_THAT(rewrite_exr(file, dir / "out.exr", replacement).recompressed, IsEmpty());
  EXPECT_EQ(ExrFile(dir / "out.exr").parts()[0].compression, "pxr24");
  expect_equal_but(dir / "in.exr", dir / "out.exr", {"0 R"});
}

std::vector<Imf::Header> many_parts() {
  std::vector<Imf::Header> headers;
  const auto add = [&](const char* name, const std::string& type, Imf::Compression compression) {
    headers.push_back(exr_header(kDisplay, kDisplay, compression));
    headers.back().setName(name);
    headers.back().setType(type);
    headers.back().setView("left");
    headers.back().channels().insert("R", Imf::Channel(Imf::HALF));
    headers.back().insert(fmt::format("attribute of {}", name), Imf::IntAttribute(3));
  };
  add("light", Imf::SCANLINEIMAGE, Imf::ZIP_COMPRESSION);
  add("lossy", Imf::SCANLINEIMAGE, Imf::B44_COMPRESSION);
  add("deep", Imf::DEEPSCANLINE, Imf::ZIPS_COMPRESSION);
  add("tiles", Imf::TILEDIMAGE, Imf::PIZ_COMPRESSION);
  headers[1].dataWindow() = kBeyond;
  headers[2].channels().insert("R", Imf::Channel(Imf::FLOAT));
  // All parts beside a deep one have this.
  for (Imf::Header& header : headers) header.setVersion(1);
  headers[3].setTileDescription(Imf::TileDescription(32, 32, Imf::MIPMAP_LEVELS));
  return headers;
}

TEST(ExrRewrite, OtherPartsAreCopied) {
  const TempDir dir;
  ExrMaker::write(dir / "in.exr", many_parts());
  const ExrFile file(dir / "in.exr");
  for (const char* name : {"light.R", "lossy.R", "tiles.R"}) {
    const int light = index_of(file, name);
    const Plane<float> pixels = new_pixels(file, light);
    const ExrReplacement replacement[] = {{light, &pixels}};
    const ExrRewriteReport report = rewrite_exr(file, dir / "out.exr", replacement);
    const int part = file.channels()[static_cast<std::size_t>(light)].part;
    if (part == 1) {
      EXPECT_THAT(report.recompressed, ElementsAre("part 'lossy': B44 becomes ZIP"));
    }
    expect_equal_but(dir / "in.exr", dir / "out.exr", {fmt::format("{} R", part)});
    const ExrFile again(dir / "out.exr");
    const Plane<float> read = std::move(again.read(std::array{light})[0]);
    for (int y = 0; y < read.height(); ++y) {
      ASSERT_EQ(std::memcmp(read.row(y), pixels.row(y), static_cast<std::size_t>(read.width()) * 4),
                0);
    }
  }
}

TEST(ExrRewrite, SmallerLevelsAreAverages) {
  const TempDir dir;
  Imf::Header header = exr_header({{0, 0}, {4, 3}}, {{0, 0}, {4, 3}}, Imf::ZIP_COMPRESSION);
  header.setTileDescription(Imf::TileDescription(4, 4, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  ExrMaker::write(dir / "in.exr", header);
  Plane<float> pixels({5, 4});
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) pixels(x, y) = static_cast<float>(10 * x + y);
  }
  const ExrReplacement replacement[] = {{0, &pixels}};
  rewrite_exr(ExrFile(dir / "in.exr"), dir / "out.exr", replacement);
  const CorePart out = CoreReader::read((dir / "out.exr").string()).parts[0];
  const auto values = [&](const char* level) {
    const std::string& bytes = out.values.at(level);
    std::vector<float> floats(bytes.size() / 4);
    std::memcpy(floats.data(), bytes.data(), bytes.size());
    return floats;
  };
  // Two columns of 2.5 pixels: (0 + 10 + 20 / 2) / 2.5 and (20 / 2 + 30 + 40) / 2.5.
  EXPECT_THAT(values("Z 1 1"), ElementsAre(8.5f, 32.5f, 10.5f, 34.5f));
  EXPECT_THAT(values("Z 2 2"), ElementsAre(21.5f));
}

TEST(ExrRewrite, ClampsAndCountsWhatHalfCannotHold) {
  const TempDir dir;
  Imf::Header header = exr_header({{0, 0}, {5, 0}}, {{0, 0}, {5, 0}}, Imf::ZIP_COMPRESSION);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  ExrMaker::write(dir / "in.exr", header);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  Plane<float> pixels({6, 1});
  const float values[] = {65519.0f, 65520.0f, -1e30f, kInf, std::nanf(""), 1.0f};
  std::copy_n(values, 6, pixels.row(0));
  const ExrReplacement replacements[] = {{0, &pixels}, {1, &pixels}};
  const ExrRewriteReport report =
      rewrite_exr(ExrFile(dir / "in.exr"), dir / "out.exr", replacements);
  EXPECT_EQ(report.values.clamped, 2);
  EXPECT_EQ(report.values.not_finite, 4);
  const std::vector<Plane<float>> read = ExrFile(dir / "out.exr").read(std::array{0, 1});
  EXPECT_EQ(read[0](0, 0), 65504.0f);
  EXPECT_EQ(read[0](1, 0), 65504.0f);
  EXPECT_EQ(read[0](2, 0), -65504.0f);
  EXPECT_EQ(read[0](3, 0), kInf);
  EXPECT_TRUE(std::isnan(read[0](4, 0)));
  EXPECT_EQ(read[1](2, 0), -1e30f);
}

TEST(ExrRewrite, RefusesChannelsThatCannotBeLight) {
  const TempDir dir;
  std::vector<Imf::Header> headers = many_parts();
  headers[0].channels().insert("id", Imf::Channel(Imf::UINT));
  headers[0].channels().insert("BY", Imf::Channel(Imf::HALF, 2, 2));
  ExrMaker::write(dir / "in.exr", headers);
  const ExrFile file(dir / "in.exr");
  const auto replace = [&](const char* name, Extent extent) {
    const Plane<float> pixels(extent);
    const ExrReplacement replacement[] = {{index_of(file, name), &pixels}};
    rewrite_exr(file, dir / "out.exr", replacement);
  };
  EXPECT_THAT(
      [&] {
        replace("light.id", {60, 50});
      },
      ThrowsMessage<BadFile>(HasSubstr("in.exr: channel 'light.id' holds integers")));
  EXPECT_THAT(
      [&] {
        replace("light.BY", {60, 50});
      },
      ThrowsMessage<BadFile>(HasSubstr("in.exr: channel 'light.BY' is subsampled")));
  EXPECT_THAT(
      [&] {
        replace("deep.R", {60, 50});
      },
      ThrowsMessage<BadFile>(HasSubstr("in.exr: channel 'deep.R' is deep")));
  EXPECT_THROW(replace("light.R", {50, 60}), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(dir / "out.exr"));
}

TEST(ExrRewrite, MayReplaceItsOwnInputAndHasTheSameBytesOnAnyNumberOfThreads) {
  const TempDir dir;
  ExrMaker::write(dir / "in.exr", many_parts());
  const ExrFile file(dir / "in.exr");
  const int light = index_of(file, "tiles.R"), other = index_of(file, "light.R");
  const Plane<float> pixels = new_pixels(file, light), others = new_pixels(file, other);
  const ExrReplacement replacements[] = {{light, &pixels}, {other, &others}};
  set_thread_count(1);
  rewrite_exr(file, dir / "one.exr", replacements);
  set_thread_count(3);
  rewrite_exr(file, dir / "in.exr", replacements);
  set_thread_count(0);
  EXPECT_TRUE(read_whole_file(dir / "one.exr") == read_whole_file(dir / "in.exr"));
}

TEST(ExrRewrite, FullDiskLeavesTheOldFile) {
  const TempDir dir;
  ExrMaker::write(dir / "in.exr", mixed_header(Imf::ZIP_COMPRESSION, Imf::INCREASING_Y));
  write_file_atomically(dir / "out.exr", "old");
  const ExrFile file(dir / "in.exr");
  const int light = index_of(file, "albedo.R");
  const Plane<float> pixels = new_pixels(file, light);
  const ExrReplacement replacement[] = {{light, &pixels}};
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{20000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  for (const bool with_pixels : {false, true}) {
    EXPECT_THAT(
        [&] {
          rewrite_exr(file, dir / "out.exr", std::span(replacement).first(with_pixels ? 1 : 0));
        },
        ThrowsMessage<std::runtime_error>(HasSubstr("out.exr: cannot write: File too large")));
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_whole_file(dir / "out.exr"), "old");
  EXPECT_FALSE(std::filesystem::exists(dir / ".out.exr.tmp"));
}

}  // namespace
}  // namespace eigenlight
