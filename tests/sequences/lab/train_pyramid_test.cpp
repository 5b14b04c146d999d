#include "sequences/lab/train_pyramid.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sequences/lab/judge_pyramid.h"
#include "tests/support/painted_picture.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

TEST(TrainPyramid, ExamplesComeFromPaintedPicturesFilesAndFrames) {
  const TempDir dir;
  write_painted_picture(dir / "picture.exr", {40, 36});
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

TEST(TrainPyramid, EveryThirdPaintedPictureIsNoisy) {
  PyramidPictures pictures;
  pictures.scenes.clear();
  pictures.painted = 6;
  pictures.seed = 7;
  std::vector<std::string> names;
  for (const auto& [name, example] : make_pyramid_examples(pictures, 1, 24)) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"painted 7", "painted 8", "painted 9, noisy",
                                             "painted 10", "painted 11", "painted 12, noisy"}));
}

// The committed table is judged on pictures that it was not trained on.
TEST(JudgePyramid, TrainedTableIsCloserToBruteForceForEachKindOfPicture) {
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

}  // namespace
}  // namespace eigenlight
