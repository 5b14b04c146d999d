#include "sequences/denoise/sequence_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "frame/bad_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class SequenceFiles : public testing::Test {
 protected:
  std::string touch(const std::string& name) {
    std::ofstream(dir_ / name) << "x";
    return (dir_ / name).string();
  }
  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  FileChoice choice(const std::string& input, const std::string& output = "out") const {
    return {{path(input)}, path(output), "", false};
  }

  TempDir dir_;
};

TEST_F(SequenceFiles, APatternFindsAllFramesThatExist) {
  for (const char* name : {"a.0003.exr", "a.0001.exr", "a.0002.exr", "a.ref.0002.exr"}) touch(name);
  const auto frames = find_sequence(choice("a.####.exr"));
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].frame, 1);
  EXPECT_EQ(frames[2].inputs.at(0), path("a.0003.exr"));
  EXPECT_EQ(frames[2].outputs.at(0), path("out/a.0003.exr"));
}

TEST_F(SequenceFiles, AFileOfThatNameIsNoPattern) {
  for (const char* name : {"shot@2x.exr", "a#1.exr", "100%done.exr", "{b} c.exr"}) {
    touch(name);
    const auto frames = find_sequence(choice(name));
    ASSERT_EQ(frames.size(), 1u) << name;
    EXPECT_EQ(frames[0].outputs.at(0), path(std::string("out/") + name));
  }
}

TEST_F(SequenceFiles, SignsInTheNameOfAFolderAreNoPlaceForTheFrame) {
  std::filesystem::create_directory(dir_ / "shot@2x");
  touch("shot@2x/a.0001.exr");
  const auto frames = find_sequence(choice("shot@2x/a.####.exr"));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].inputs.at(0), path("shot@2x/a.0001.exr"));
}

TEST_F(SequenceFiles, RegularStepsAreOneShotAndHolesAreNamed) {
  for (const char* name : {"a.0001.exr", "a.0005.exr", "a.0009.exr"}) touch(name);
  EXPECT_EQ(find_sequence(choice("a.####.exr")).size(), 3u);
  touch("a.0002.exr");
  EXPECT_THAT([&] { (void)find_sequence(choice("a.####.exr")); },
              ThrowsMessage<std::runtime_error>(HasSubstr("a.0003.exr: frame 3 is missing")));
}

TEST_F(SequenceFiles, AnInputIsNeverWrittenUnlessAsked) {
  touch("a.0001.exr");
  FileChoice files = choice("a.####.exr", ".");
  EXPECT_THAT([&] { (void)find_sequence(files); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("is an input")));
  files.output = path("a.####.exr");
  EXPECT_THAT([&] { (void)find_sequence(files); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("is an input")));
  files.overwrite = true;
  EXPECT_EQ(find_sequence(files).size(), 1u);
}

TEST_F(SequenceFiles, SeveralInputsNeedAFolderAndOtherNames) {
  touch("a.0001.exr");
  touch("b.0001.exr");
  FileChoice files{{path("a.####.exr"), path("b.####.exr")}, path("out.####.exr"), "", false};
  EXPECT_THAT([&] { (void)find_sequence(files); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected a folder")));
  files.output = path("out");
  EXPECT_EQ(find_sequence(files).at(0).outputs.at(1), path("out/b.0001.exr"));
}

TEST_F(SequenceFiles, OneNameForTwoFramesIsRefused) {
  touch("a.0001.exr");
  touch("a.0002.exr");
  EXPECT_THAT([&] { (void)find_sequence(choice("a.####.exr", "one.exr")); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("would be written twice")));
}

TEST_F(SequenceFiles, AMissingFrameIsNamed) {
  touch("a.0001.exr");
  FileChoice files = choice("a.####.exr");
  files.frames = "1-2";
  EXPECT_THAT([&] { (void)find_sequence(files); },
              ThrowsMessage<std::runtime_error>(HasSubstr("a.0002.exr: no such file")));
  EXPECT_THAT([&] { (void)find_sequence(choice("b.####.exr")); },
              ThrowsMessage<BadFile>(HasSubstr("no such files")));
}

}  // namespace
}  // namespace eigenlight
