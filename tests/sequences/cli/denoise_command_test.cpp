// `eigenlight denoise` as a user types it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "sequences/files/atomic_file.h"
#include "tests/support/command_line.h"
#include "tests/support/fake_shot.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

class DenoiseCommand : public testing::Test {
 protected:
  DenoiseCommand() {
    for (int frame = 1; frame <= 3; ++frame) {
      FakeShot().write(dir_ / ("s.000" + std::to_string(frame) + ".exr"), frame);
    }
  }
  Outcome denoise(std::vector<std::string> more) {
    std::vector<std::string> words{"denoise", (dir_ / "s.####.exr").string(), "-o",
                                   (dir_ / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }

  TempDir dir_;
};

TEST_F(DenoiseCommand, WritesEachFrameAndSaysWhatItDid) {
  const Outcome outcome = denoise({});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("light     View.DiffInd   0:0   half   denoised"));
  EXPECT_THAT(outcome.err, HasSubstr("frame 3  3/3"));
  EXPECT_THAT(outcome.out, HasSubstr("3 frames in "));
  for (const char* name : {"s.0001.exr", "s.0002.exr", "s.0003.exr"}) {
    EXPECT_TRUE(std::filesystem::exists(dir_ / "out" / name)) << name;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_ / "out"), {}), 3);
}

TEST_F(DenoiseCommand, ADryRunWritesNothing) {
  const Outcome outcome = denoise({"--dry-run", "--json"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["frames"], "1-3");
  EXPECT_EQ(json["canvas"]["width"], 96);
  bool has_beauty = false;
  for (const auto& layer : json["layers"]) {
    has_beauty |= layer["role"] == "beauty" && layer["use"] == "composed";
  }
  EXPECT_TRUE(has_beauty);
}

TEST_F(DenoiseCommand, APageStandsBesideTheOutputs) {
  const Outcome outcome = denoise({"--page"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("out/page/index.html\n"));
  const std::string page = read_whole_file(dir_ / "out/page/index.html");
  EXPECT_THAT(page, HasSubstr("s.0001.exr to s.0003.exr, denoised"));
  EXPECT_THAT(page, HasSubstr("data:image/jpeg"));
  // Pages never change frames.
  EXPECT_EQ(call({"denoise", (dir_ / "s.####.exr").string(), "-o", (dir_ / "b").string()}).status,
            0);
  for (const char* name : {"s.0001.exr", "s.0002.exr", "s.0003.exr"}) {
    EXPECT_EQ(read_whole_file(dir_ / "out" / name), read_whole_file(dir_ / "b" / name)) << name;
  }
}

TEST_F(DenoiseCommand, QuietPrintsNothing) {
  const Outcome outcome = denoise({"-q"});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out + outcome.err, "");
}

TEST_F(DenoiseCommand, WhatIsWrongIsOneLineAndStatus2) {
  struct Wrong {
    std::vector<std::string> words;
    std::string line;
  };
  const std::vector<Wrong> all{
      {{"--frames", "1-4"}, "s.0004.exr: no such file"},
      {{"--map", "albedo=nothing"}, "--map albedo=nothing: no such layer"},
      {{"--motion", "sideways"}, "sideways"},
      {{"--camera", (dir_ / "none.json").string()}, "none.json"},
      {{"--cuts", "x"}, "x"},
  };
  for (const Wrong& wrong : all) {
    const Outcome outcome = denoise(wrong.words);
    EXPECT_NE(outcome.status, 0) << wrong.line;
    EXPECT_THAT(outcome.err, HasSubstr(wrong.line));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "out"));
  }
}

}  // namespace
}  // namespace eigenlight
