// The built program as a process: interrupted and resumed runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "sequences/files/atomic_file.h"
#include "sequences/files/file_pattern.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

// Enough samples that a frame can be interrupted.
constexpr const char* kSpp = "8";
constexpr const char* kFrames = "0-15";
constexpr int kLast = 15;

class EndToEnd : public testing::Test {
 protected:
  std::vector<std::string> command(const std::string& name) const {
    return {EIGENLIGHT_BINARY, "render",   "cornell",        "-o",    dir_ / name, "--size",
            "64x36",           "--frames", kFrames,          "--spp", kSpp,        "--method",
            method_,           "--layers", "color,noisy,age"};
  }
  static std::vector<std::string> resumed(std::vector<std::string> words) {
    words.push_back("--resume");
    return words;
  }
  [[nodiscard]] std::filesystem::path frame(const std::string& name, int number) const {
    return dir_ / name / FilePattern(kFramePattern).name(number);
  }
  void wait_for_frame(const std::string& name, int number) const {
    for (int i = 0; i < 2000 && !std::filesystem::exists(frame(name, number)); ++i) {
      std::this_thread::sleep_for(5ms);
    }
  }
  void expect_same_frames(const std::string& a, const std::string& b) const {
    for (int i = 0; i <= kLast; ++i) {
      EXPECT_TRUE(read_whole_file(frame(a, i)) == read_whole_file(frame(b, i))) << "frame " << i;
    }
  }
  [[nodiscard]] std::size_t temporary_files(const std::string& name) const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / name)) {
      if (entry.path().extension() == ".tmp") ++count;
    }
    return count;
  }

  const char* method_ = "noisy";
  TempDir dir_;
};

// A method without history, and one whose history must be restored.
class EndToEndOf : public EndToEnd, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override { method_ = GetParam(); }
};

TEST_P(EndToEndOf, ResumedRunEqualsAnUninterruptedOne) {
  Process whole(command("whole"));
  ASSERT_EQ(whole.wait(), 0) << whole.err();

  Process interrupted(command("parts"));
  wait_for_frame("parts", 2);
  interrupted.signal(SIGINT);
  ASSERT_EQ(interrupted.wait(), 130) << interrupted.err();
  EXPECT_FALSE(std::filesystem::exists(frame("parts", kLast)));
  EXPECT_THAT(interrupted.err(), HasSubstr("--resume"));
  EXPECT_EQ(temporary_files("parts"), 0u);

  Process rest(resumed(command("parts")));
  ASSERT_EQ(rest.wait(), 0) << rest.err();
  EXPECT_THAT(rest.err(), HasSubstr("complete before"));
  expect_same_frames("whole", "parts");
  const std::string log = read_whole_file(dir_ / "parts/frames.jsonl");
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), kLast + 1);
}

TEST_F(EndToEnd, ResumedAntialiasedRunEqualsAnUninterruptedOne) {
  const auto with_aa = [&](const std::string& name) {
    std::vector<std::string> words = command(name);
    words.insert(words.end(), {"--aa", "sraa"});
    return words;
  };
  Process whole(with_aa("whole"));
  Process interrupted(with_aa("parts"));
  wait_for_frame("parts", 2);
  interrupted.signal(SIGINT);
  ASSERT_EQ(interrupted.wait(), 130) << interrupted.err();
  ASSERT_EQ(whole.wait(), 0) << whole.err();
  Process rest(resumed(with_aa("parts")));
  ASSERT_EQ(rest.wait(), 0) << rest.err();
  expect_same_frames("whole", "parts");
}

TEST_F(EndToEnd, KilledRunCanBeResumed) {
  Process whole(command("whole"));
  ASSERT_EQ(whole.wait(), 0) << whole.err();
  Process killed(command("parts"));
  wait_for_frame("parts", 1);
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(), 128 + SIGKILL);
  Process rest(resumed(command("parts")));
  ASSERT_EQ(rest.wait(), 0) << rest.err();
  expect_same_frames("whole", "parts");
}

TEST_F(EndToEnd, SecondInterruptEndsTheProgramAtOnce) {
  std::vector<std::string> words = command("slow");
  for (std::string& word : words) {
    if (word == kSpp) word = "60000";
  }
  Process slow(words);
  // run.json is written just before the first frame begins.
  for (int i = 0; i < 2000 && !std::filesystem::exists(dir_ / "slow/frames.jsonl"); ++i) {
    std::this_thread::sleep_for(5ms);
  }
  slow.signal(SIGINT);
  std::this_thread::sleep_for(50ms);
  const auto start = std::chrono::steady_clock::now();
  slow.signal(SIGINT);
  EXPECT_EQ(slow.wait(), 130);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
  EXPECT_THAT(slow.err(), HasSubstr("again to stop at once"));
  EXPECT_EQ(temporary_files("slow"), 0u);
}

TEST_F(EndToEnd, DamagedCheckpointIsAnError) {
  std::vector<std::string> words = command("a");
  for (std::string& word : words) {
    if (word == kFrames) word = "0";
  }
  Process run(words);
  ASSERT_EQ(run.wait(), 0) << run.err();
  std::string state = read_whole_file(dir_ / "a/state.bin");
  state.back() = static_cast<char>(state.back() ^ 1);
  write_file_atomically(dir_ / "a/state.bin", state);
  Process rest(resumed(words));
  EXPECT_EQ(rest.wait(), 2);
  EXPECT_THAT(rest.err(), HasSubstr("state.bin: damaged"));
}

INSTANTIATE_TEST_SUITE_P(Methods, EndToEndOf, testing::Values("noisy", "eigenlight"),
                         [](const auto& method) { return std::string(method.param); });

}  // namespace
}  // namespace eigenlight
