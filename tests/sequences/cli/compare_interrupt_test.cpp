// The built program as a process: a comparison that is interrupted goes on with the same figures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "sequences/files/atomic_file.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using namespace std::chrono_literals;

class CompareInterrupt : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> command(const std::string& name) const {
    return {EIGENLIGHT_BINARY,
            "compare",
            "cornell",
            "-o",
            dir_ / name,
            "--cache",
            dir_ / (name + "-references"),
            "--size",
            "48x27",
            "--frames",
            "2-7",
            "--warmup",
            "2",
            "--reference-spp",
            "64",
            "--spp",
            "1,8",
            "--methods",
            "noisy,mean"};
  }
  // Until `directory` holds a file that ends as `ending`, at most ten seconds.
  static void wait_for_file(const fs::path& directory, const std::string& ending) {
    for (int i = 0; i < 2000 && !has_file(directory, ending); ++i) std::this_thread::sleep_for(5ms);
  }
  static bool has_file(const fs::path& directory, const std::string& ending) {
    std::error_code error;
    for (const auto& entry : fs::recursive_directory_iterator(directory, error)) {
      if (entry.path().string().ends_with(ending)) return true;
    }
    return false;
  }
  // Interrupts when a file appears, goes on, and compares with an uninterrupted run.
  void interrupt_at(const std::string& where, const std::string& ending) {
    Process interrupted(command("parts"));
    wait_for_file(dir_ / where, ending);
    interrupted.signal(SIGINT);
    ASSERT_EQ(interrupted.wait(), 130) << interrupted.err();
    EXPECT_THAT(interrupted.err(), HasSubstr("to go on:\n  "));
    EXPECT_FALSE(has_file(dir_.path(), ".tmp"));
    EXPECT_FALSE(fs::exists(dir_ / "parts/index.html"));
    EXPECT_FALSE(fs::exists(dir_ / "parts/scratch"));
    Process rest(command("parts"));
    ASSERT_EQ(rest.wait(), 0) << rest.err();
    Process whole(command("whole"));
    ASSERT_EQ(whole.wait(), 0) << whole.err();
    EXPECT_EQ(figures("parts"), figures("whole"));
  }
  [[nodiscard]] std::vector<nlohmann::json> figures(const std::string& name) const {
    const auto results = nlohmann::json::parse(read_whole_file(dir_ / name / "results.json"));
    std::vector<nlohmann::json> found;
    for (const auto& cell : results["scenes"][0]["cells"]) found.push_back(cell["per_frame"]);
    return found;
  }

  TempDir dir_;
};

TEST_F(CompareInterrupt, GoesOnAfterAnInterruptInReferences) {
  interrupt_at("parts-references", "a/frame.0002.exr");
}

TEST_F(CompareInterrupt, GoesOnAfterAnInterruptInMeasuring) {
  interrupt_at("parts", "noisy/frame.0002.exr");
}

}  // namespace
}  // namespace eigenlight
