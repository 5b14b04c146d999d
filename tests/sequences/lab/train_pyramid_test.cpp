#include "sequences/lab/train_pyramid.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "frame/tiles.h"
#include "sequences/cli/cli.h"
#include "sequences/files/exr_io.h"
#include "sequences/lab/judge_pyramid.h"
#include "spatial/training/training_images.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

struct Outcome {
  int status = 0;
  std::string err;
};

Outcome call(const std::vector<std::string>& words) {
  std::vector<const char*> args{"eigenlight", "train-pyramid"};
  for (const std::string& word : words) args.push_back(word.c_str());
  std::ostringstream out, err;
  const int status = run_command_line(args, {out, err, false, ""});
  set_thread_count(0);
  return {status, err.str()};
}

void write_picture(const std::filesystem::path& path, Extent extent) {
  const Planes<3> image = paint_training_image(extent, 5);
  const std::vector<ExrChannel> channels{{"R", ExrType::kFloat, &image[0]},
                                         {"G", ExrType::kFloat, &image[1]},
                                         {"B", ExrType::kFloat, &image[2]}};
  write_exr(path, channels, {});
}

TEST(TrainPyramid, LearnsFromPicturesFilesAndFrames) {
  const TempDir dir;
  write_picture(dir / "picture.exr", {40, 36});
  PyramidPictures options;
  options.painted = 2;
  options.images = {(dir / "picture.exr").string()};
  options.scenes = {"cornell"};
  const std::vector<NamedExample> examples = make_pyramid_examples(options, 2, 32);
  ASSERT_EQ(examples.size(), 4u);
  for (const auto& [name, example] : examples) {
    EXPECT_EQ(example.passes(), 2);
    EXPECT_EQ(example.target()[0].extent(), (Extent{32, 32}));
    double light = 0.0;
    for (int y = 0; y < 32; ++y) light += static_cast<double>(example.target()[0](y, y));
    EXPECT_GT(light, 0.0);
  }
}

// Every third painted picture is noise around the clean picture that guides it.
TEST(TrainPyramid, SomePaintedPicturesAreNoisy) {
  PyramidPictures pictures;
  pictures.scenes.clear();
  pictures.painted = 6;
  pictures.seed = 7;
  std::vector<std::string> names;
  for (const auto& [name, example] : make_pyramid_examples(pictures, 1, 24)) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"painted 7", "painted 8", "painted 9, noisy",
                                             "painted 10", "painted 11", "painted 12, noisy"}));
}

// Of the committed table, on what it was not trained on.
TEST(JudgePyramid, TheTrainedTableIsCloserToBruteForceOnEveryKindOfPicture) {
  PyramidPictures pictures{.painted = 6, .seed = 1000, .scenes = {"cornell"}, .frame = 40};
  for (const int radius : {2, 8, 32}) {
    const std::vector<PyramidJudgement> kinds = judge_pyramid(pictures, radius, 64);
    ASSERT_EQ(kinds.size(), 3u);
    EXPECT_EQ(kinds[0].pictures, 4);
    EXPECT_EQ(kinds[1].kind, "painted, noisy");
    for (const PyramidJudgement& j : kinds) {
      EXPECT_GT(j.trained.psnr, j.untrained.psnr) << j.kind << ", radius " << radius;
    }
  }
}

TEST(JudgePyramid, RefusesBadOptions) {
  const auto judge = [](std::vector<const char*> words) {
    words.insert(words.begin(), {"eigenlight", "judge-pyramid", "--painted", "1", "--side", "16"});
    std::ostringstream out, err;
    const int status = run_command_line(words, {out, err, false, ""});
    set_thread_count(0);
    return status;
  };
  EXPECT_EQ(judge({"--radii", "0"}), 2);
  EXPECT_EQ(judge({"--radii", "65"}), 2);
  EXPECT_EQ(judge({"--scenes", "nowhere"}), 2);
  EXPECT_EQ(judge({"--side", "4"}), 2);
}

TEST(TrainPyramid, NamesAFileThatIsMissingOrTooSmall) {
  const TempDir dir;
  const std::string table = (dir / "table.cpp").string();
  const Outcome missing = call({"-o", table, "--painted", "0", "--images", "no/such.png"});
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.err.find("no/such.png"), std::string::npos) << missing.err;
  write_picture(dir / "small.exr", {40, 36});
  const Outcome small =
      call({"-o", table, "--painted", "0", "--images", (dir / "small.exr").string()});
  EXPECT_EQ(small.status, 1);
  EXPECT_NE(small.err.find("small.exr: 40x36 pixels, expected 128"), std::string::npos)
      << small.err;
  EXPECT_FALSE(std::filesystem::exists(table));
}

TEST(TrainPyramid, RefusesBadOptions) {
  EXPECT_EQ(call({"--painted", "1"}).status, 2);
  EXPECT_EQ(call({"-o", "x", "--painted", "65"}).status, 2);
  EXPECT_EQ(call({"-o", "x", "--steps", "-1"}).status, 2);
  EXPECT_EQ(call({"-o", "x", "--painted", "0", "--scenes", "nowhere"}).status, 2);
}

}  // namespace
}  // namespace eigenlight
