// Exit status of `eigenlight denoise`: whether the same command may work later.
#include <OpenEXR/ImfStandardAttributes.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sequences/files/atomic_file.h"
#include "tests/support/command_line.h"
#include "tests/support/exr_maker.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class DenoiseStatus : public testing::Test {
 protected:
  DenoiseStatus() {
    for (int frame = 1; frame <= 3; ++frame) FakeShot().write(in(frame), frame);
  }
  std::filesystem::path in(int frame) const {
    return dir_ / ("s.000" + std::to_string(frame) + ".exr");
  }
  Outcome denoise(const std::vector<std::string>& more) const {
    return denoise_file("s.####.exr", more);
  }
  Outcome denoise_file(const std::string& name, const std::vector<std::string>& more) const {
    std::vector<std::string> words{"denoise", (dir_ / name).string(), "-o",
                                   (dir_ / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
  void expect(const Outcome& outcome, int status, const std::string& line) const {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(line));
    EXPECT_THAT(outcome.err.substr(outcome.err.rfind("eigenlight: ")), StartsWith("eigenlight: "));
  }
  void cut(int frame, std::size_t bytes) const {
    write_file_atomically(in(frame), read_whole_file(in(frame)).substr(0, bytes));
  }

  TempDir dir_;
};

TEST_F(DenoiseStatus, AFrameThatIsNotThereYetIs1) {
  expect(denoise({"--frames", "1-4"}), 1, "s.0004.exr: no such file");
  expect(denoise_file("later.####.exr", {"--frames", "1-2"}), 1, "later.0001.exr: no such file");
  FakeShot().write(dir_ / "s.0005.exr", 5);
  expect(denoise({}), 1, "frame 4 is missing");
}

TEST_F(DenoiseStatus, AFileThatIsNotWholeYetIs1) {
  const std::size_t size = std::filesystem::file_size(in(2));
  cut(2, size - 100);
  expect(denoise({}), 1, "s.0002.exr");
  cut(2, 1000);
  expect(denoise({}), 1, "s.0002.exr: cannot read");
  cut(2, 0);
  expect(denoise({}), 1, "s.0002.exr: cannot read: the file ends early");
  write_file_atomically(in(2), std::string(5000, '\0'));
  expect(denoise({}), 1, "s.0002.exr: cannot read: it starts with zeros");
}

TEST_F(DenoiseStatus, AnOutputThatCannotBeWrittenIs1) {
  std::filesystem::create_directories(dir_ / "out/s.0001.exr");
  expect(denoise({}), 1, "s.0001.exr: cannot write: ");
}

TEST_F(DenoiseStatus, WrongNamesAre2) {
  expect(denoise_file("nothing.####.exr", {}), 2, "no such files");
  expect(denoise_file("nothing.exr", {}), 2, "nothing.exr: no such file");
  expect(denoise_file("nowhere/s.####.exr", {"--frames", "1-2"}), 2, "no such file");
  expect(denoise_file("s.####.####.exr", {}), 2, "more than one place");
  expect(denoise({"--camera", "none.json"}), 2, "--camera none.json: no such file");
  std::ofstream(dir_ / "out") << "x";
  expect(denoise({}), 2, "is a file, expected a folder");
}

TEST_F(DenoiseStatus, WrongOptionsAre2) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> all{
      {{"--map", "albedo=nothing"}, "--map albedo=nothing: no such layer"},
      {{"--map", "depth=id"}, "--map depth=id: integers"},
      {{"--map", "light=id"}, "--map light=id: integers"},
      {{"--map", "normal=matte"}, "--map normal=matte: 1 channels, expected 3"},
      {{"--motion", "sideways"}, "sideways"},
      {{"--cuts", "x"}, "frames 'x'"},
      {{"--frames", "1-"}, "frames '1-'"},
      {{"--keep", "("}, "--keep '('"},
      {{"--alpha", "maybe"}, "--alpha: maybe"},
      {{"-o", dir_.path().string()}, "is an input"},
      {{"--frobnicate"}, "--frobnicate"},
  };
  for (const auto& [words, line] : all) expect(denoise(words), 2, line);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
}

TEST_F(DenoiseStatus, FilesOfAnotherKindAre2) {
  write_file_atomically(in(2), "This is a text, and no picture.");
  expect(denoise({}), 2, "s.0002.exr: cannot read: not an OpenEXR file");
  std::filesystem::remove(in(2));
  std::filesystem::create_directory(in(2));
  expect(denoise({}), 2, "s.0002.exr: cannot read: is a directory");
}

TEST_F(DenoiseStatus, FramesThatAreNotAlikeAre2) {
  FakeShot small;
  small.extent = {48, 32};
  small.write(in(2), 2);
  expect(denoise({}), 2, "s.0002.exr: display window of 48x32 pixels, expected 96x64 as in ");
  FakeShot other;
  other.has_albedo = false;
  other.write(in(2), 2);
  expect(denoise({}), 2, "s.0002.exr: no channel 'View.DiffInd.R', which the first frame has");
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
}

TEST_F(DenoiseStatus, LightThatCannotBeDenoisedIs2) {
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(15, 7));
  Imf::Header deep = exr_header(window, window, Imf::ZIPS_COMPRESSION);
  for (const char* name : {"R", "G", "B"}) deep.channels().insert(name, Imf::Channel(Imf::FLOAT));
  deep.setName("deep");
  deep.setType(Imf::DEEPSCANLINE);
  ExrMaker::write(dir_ / "deep.exr", std::vector<Imf::Header>{deep});
  expect(denoise_file("deep.exr", {}), 2, "deep.exr: layer 'color': deep data");
  Imf::Header sub = exr_header(window, window, Imf::ZIP_COMPRESSION);
  sub.channels().insert("R", Imf::Channel(Imf::HALF));
  sub.channels().insert("G", Imf::Channel(Imf::HALF, 2, 2));
  sub.channels().insert("B", Imf::Channel(Imf::HALF, 2, 2));
  ExrMaker::write(dir_ / "sub.exr", sub);
  expect(denoise_file("sub.exr", {}), 2, "sub.exr: layer 'color': subsampled channels");
}

TEST_F(DenoiseStatus, AForeignCheckpointIs2) {
  std::filesystem::create_directory(dir_ / "out");
  std::ofstream(dir_ / "out/.s.0001.exr.eigenlight-state") << "not a checkpoint";
  expect(denoise({"--resume"}), 2, ".eigenlight-state: not a checkpoint");
}

}  // namespace
}  // namespace eigenlight
