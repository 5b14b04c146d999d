#include "sequences/runs/run_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>

#include "sequences/files/atomic_file.h"
#include "sequences/files/checkpoint.h"
#include "sequences/files/file_pattern.h"
#include "temporal/baselines/frame_by_frame.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kRun = R"({"scene": "atrium", "spp": 3})";
const std::vector<int> kFrames{4, 5, 6};

class RunDirectoryTest : public testing::Test {
 protected:
  void pretend_frame(int frame) {
    std::ofstream(dir_ / FilePattern(kFramePattern).name(frame)) << "x";
  }
  std::string refusal(const std::string& run) {
    try {
      (void)open(run).resume(kFrames, {denoiser_});
    } catch (const CheckpointError& error) {
      return error.what();
    }
    return "not refused";
  }

  // A directory is that of one run at a time.
  const RunDirectory& open(const std::string& run) {
    run_.reset();
    run_ = std::make_unique<RunDirectory>(dir_.path(), run);
    return *run_;
  }

  TempDir dir_;
  std::unique_ptr<RunDirectory> run_;
  FrameByFrame denoiser_{{{8, 8}, 3}, "noisy"};
};

TEST_F(RunDirectoryTest, ResumesAfterTheSavedFrame) {
  const RunDirectory run(dir_.path(), kRun);
  run.begin();
  pretend_frame(4);
  pretend_frame(5);
  run.save(2, {denoiser_});
  EXPECT_EQ(run.resume(kFrames, {denoiser_}), 2u);
  // Beginning anew forgets it.
  run.begin();
  EXPECT_FALSE(std::filesystem::exists(dir_ / "state.bin"));
  EXPECT_EQ(run.resume(kFrames, {denoiser_}), 0u);
}

TEST_F(RunDirectoryTest, TwoRunsDoNotWriteIntoOneDirectory) {
  open(kRun);
  EXPECT_THAT([&] { RunDirectory(dir_.path(), kRun); },
              ThrowsMessage<std::runtime_error>(HasSubstr("another run is writing into this")));
  run_.reset();
  EXPECT_NO_THROW(RunDirectory(dir_.path(), kRun));
}

TEST_F(RunDirectoryTest, FramesOfAnotherRunAreTold) {
  for (const int frame : {0, 1, 4, 5, 9}) pretend_frame(frame);
  EXPECT_THAT(open(kRun).foreign_frames(kFrames),
              HasSubstr("holds 3 frames of another run beside those of this one: 0-1,9"));
  run_->begin();  // now they count as its own
  EXPECT_EQ(run_->foreign_frames(kFrames), "");
}

TEST_F(RunDirectoryTest, CheckpointOfAnotherRunIsAnError) {
  const auto run = [&]() -> const RunDirectory& { return open(kRun); };
  EXPECT_EQ(run().resume(kFrames, {denoiser_}), 0u);
  const std::string other = R"({"scene": "atrium", "spp": 8})";
  EXPECT_THAT(refusal(other), HasSubstr("run.json: of another run: spp is 3 there, 8 here"));
  run().save(0, {denoiser_});
  EXPECT_THAT(refusal(other), HasSubstr("state.bin: of another run: spp is 3 there, 8 here"));
  run().save(1, {denoiser_});
  EXPECT_THAT(refusal(kRun), HasSubstr("frame.0004.exr is missing"));
  run().save(4, {denoiser_});
  EXPECT_THAT(refusal(kRun), HasSubstr("4 frames complete, but the run has 3"));
  std::string bytes = read_whole_file(dir_ / "state.bin");
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write_file_atomically(dir_ / "state.bin", bytes);
  EXPECT_THAT(refusal(kRun), HasSubstr("state.bin: damaged: the checksum does not match"));
  // A checksum that fits does not make a state of another method fit.
  StateWriter alien;
  alien.value("mean", 1u);
  write_checkpoint(dir_ / "state.bin", {kRun, 0, alien.bytes()});
  EXPECT_THAT(refusal(kRun), HasSubstr("state.bin: state of 'noisy': found 'mean'"));
}

TEST_F(RunDirectoryTest, DirectoryThatCannotBeMadeIsNamed) {
  std::ofstream(dir_ / "file") << "x";
  EXPECT_THAT([&] { RunDirectory(dir_ / "file", kRun); },
              ThrowsMessage<std::runtime_error>(HasSubstr("file: cannot make the directory: ")));
  EXPECT_THAT(
      [&] { RunDirectory(dir_ / "file/sub", kRun); },
      ThrowsMessage<std::runtime_error>(HasSubstr("file/sub: cannot make the directory: ")));
}

}  // namespace
}  // namespace eigenlight
