// `eigenlight denoise` killed at random moments. EIGENLIGHT_KILLS sets how many kills (10; by hand:
// 200), EIGENLIGHT_SEED their moments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "sequences/denoise/denoise_record.h"
#include "sequences/files/atomic_file.h"
#include "tests/support/fake_shot.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kFrames = 8;

int number_from(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

// The frames that stand under their final names.
std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("s.") && name.ends_with(".exr")) names.insert(name);
  }
  return names;
}

// And their bytes.
std::map<std::string, std::string> frames_in(const fs::path& folder) {
  std::map<std::string, std::string> frames;
  for (const std::string& name : names_in(folder)) frames[name] = read_whole_file(folder / name);
  return frames;
}

// Where the kills hit.
struct Found {
  int kills = 0, with_checkpoint = 0, while_writing = 0;
  std::map<std::size_t, int> by_frames;

  void count(const fs::path& out, std::size_t frames) {
    ++kills;
    ++by_frames[frames];
    with_checkpoint += fs::exists(out / ".s.0001.exr.eigenlight-state") ? 1 : 0;
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(out, error)) {
      if (entry.path().extension() != ".tmp") continue;
      ++while_writing;
      break;
    }
  }
  void print() const {
    std::printf("%d kills: %d behind a checkpoint, %d while a file was written\n", kills,
                with_checkpoint, while_writing);
    for (const auto& [frames, times] : by_frames) {
      std::printf("  %d with %zu of %d frames\n", times, frames, kFrames);
    }
  }
};

class DenoiseKill : public testing::Test {
 protected:
  DenoiseKill() {
    FakeShot shot{.extent = {160, 96}};
    for (int frame = 1; frame <= kFrames; ++frame) {
      shot.write(dir_ / ("s.000" + std::to_string(frame) + ".exr"), frame);
    }
  }
  [[nodiscard]] std::vector<std::string> command(const fs::path& out, bool has_page) const {
    // A checkpoint behind each frame, so that most resumed runs start in the middle.
    std::vector<std::string> words{
        EIGENLIGHT_BINARY, "denoise", dir_ / "s.####.exr", "-o", out, "--resume",
        "--checkpoint",    "0",       "--threads",         "2"};
    if (has_page) words.push_back("--page");
    return words;
  }
  // Seconds until the first frame stands there, and until the end, of a run that nobody stops.
  struct Times {
    double first = 0.0, all = 0.0;
  };
  Times run_whole(const fs::path& out, bool has_page) const {
    const auto start = Clock::now();
    const auto seconds = [&] {
      return std::chrono::duration<double>(Clock::now() - start).count();
    };
    Process process(command(out, has_page));
    Times times;
    wait_for(out, 1);
    times.first = seconds();
    EXPECT_EQ(process.wait(), 0) << process.err();
    times.all = seconds();
    return times;
  }
  // Until so many frames stand there; not for ever.
  static void wait_for(const fs::path& out, std::size_t frames) {
    const auto start = Clock::now();
    while (names_in(out).size() < frames && Clock::now() - start < std::chrono::seconds(30)) {
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  }
  // Kills a run `seconds` after so many frames stand there. True if it was still running.
  bool kill_after(std::size_t frames, double seconds, const fs::path& out, bool has_page) const {
    Process process(command(out, has_page));
    wait_for(out, frames);
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    process.signal(SIGKILL);
    const int status = process.wait();
    EXPECT_TRUE(status == 0 || status == 128 + SIGKILL) << status << ' ' << process.err();
    return status != 0;
  }
  // Whatever stands under a final name is whole and right, and nothing that stood there is gone.
  void check_frames(const fs::path& out, std::set<std::string>& finished) const {
    const auto found = frames_in(out);
    for (const std::string& name : finished) EXPECT_EQ(found.count(name), 1u) << name << " is lost";
    for (const auto& [name, bytes] : found) {
      EXPECT_TRUE(bytes == whole_.at(name)) << name << " differs from an uninterrupted run";
      finished.insert(name);
    }
  }
  void check_end(const fs::path& out, bool has_page) const {
    EXPECT_TRUE(frames_in(out) == whole_) << "frames differ from an uninterrupted run";
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(out)) names.insert(entry.path().filename());
    std::set<std::string> expected;
    for (const auto& [name, bytes] : whole_) expected.insert(name);
    if (has_page) expected.insert("page");
    EXPECT_EQ(names, expected) << "files are left over";
    if (!has_page) return;
    std::vector<int> all;
    for (int frame = 1; frame <= kFrames; ++frame) all.push_back(frame);
    EXPECT_EQ(DenoiseLog::read(out / "page/frames.jsonl", all).size(), all.size());
    EXPECT_TRUE(read_whole_file(out / "page/index.html").ends_with("</html>\n"));
  }

  TempDir dir_;
  std::map<std::string, std::string> whole_;
};

TEST_F(DenoiseKill, LosesNoFinishedFileAndGoesOnWithTheSameBits) {
  const int most = number_from("EIGENLIGHT_KILLS", 10);
  std::mt19937 random(static_cast<unsigned>(number_from("EIGENLIGHT_SEED", 1)));
  const auto draw = [&](double end) {
    return std::uniform_real_distribution<double>(0.0, end)(random);
  };
  const Times times = run_whole(dir_ / "whole", false);
  whole_ = frames_in(dir_ / "whole");
  ASSERT_EQ(whole_.size(), static_cast<std::size_t>(kFrames));
  Found found;
  for (int round = 0; found.kills < most && !HasFailure(); ++round) {
    const fs::path out = dir_ / ("out" + std::to_string(round));
    const bool has_page = round % 2 == 1;
    std::set<std::string> finished;
    // One to three kills, one behind the other, each some frames later.
    for (int left = 1 + static_cast<int>(random() % 3u); left > 0 && found.kills < most; --left) {
      const std::size_t more = random() % 5u;
      const double seconds =
          more == 0 ? draw(times.first) : draw((times.all - times.first) / kFrames);
      if (!kill_after(finished.size() + more, seconds, out, has_page)) break;
      check_frames(out, finished);
      found.count(out, finished.size());
    }
    (void)run_whole(out, has_page);
    check_end(out, has_page);
    fs::remove_all(out);
  }
  found.print();
  EXPECT_GT(found.with_checkpoint, 0);
}

}  // namespace
}  // namespace eigenlight
