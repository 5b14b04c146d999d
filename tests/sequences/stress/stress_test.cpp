// The quick cases of `eigenlight stress`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>

#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/stress/stress_case.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

// Statistics over a thousand seeds take too long here; `eigenlight stress` has them.
std::vector<StressCase> quick_cases() {
  std::vector<StressCase> cases = stress_cases();
  std::erase_if(cases,
                [](const StressCase& c) { return c.is_long || c.name.starts_with("statistics."); });
  return cases;
}

class StressCaseTest : public testing::TestWithParam<StressCase> {};

TEST_P(StressCaseTest, StaysWithinItsBound) {
  StressLog log(0);
  const StressFinding finding = GetParam().run(log);
  EXPECT_TRUE(finding.pass()) << finding.figure << " against " << finding.bound << " ("
                              << GetParam().what << "; " << finding.where << "): eigenlight stress"
                              << " --case " << GetParam().name;
  EXPECT_GT(log.steps(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, StressCaseTest, testing::ValuesIn(quick_cases()),
                         [](const auto& stress) {
                           std::string name(stress.param.name);
                           std::replace_if(
                               name.begin(), name.end(),
                               [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

TEST(StressCases, NamesAreUniqueAndOfFormThemeDotCase) {
  std::set<std::string_view> names;
  for (const StressCase& c : stress_cases()) {
    EXPECT_EQ(std::count(c.name.begin(), c.name.end(), '.'), 1) << c.name;
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_FALSE(c.what.empty());
  }
}

// A failing case whose figure grows to frame 5 of the second run.
TEST(StressRecording, KeepsTheWorstFrameTheOneBeforeAndTheHistory) {
  const TempDir dir;
  const auto play = [](StressLog& log) {
    for (int run = 0; run < 2; ++run) {
      StressRun frames(log, {.extent = {9, 7}, .frames = 8});
      while (frames.step()) {
        const int frame = frames.frame().index;
        log.note(run == 1 && frame <= 5 ? frame : 0.0, "here");
      }
    }
  };
  StressLog first(3);
  play(first);
  EXPECT_EQ(first.worst(), 5.0);
  EXPECT_EQ(first.worst_what(), "here");
  EXPECT_EQ(first.worst_step(), 8 + 6);
  StressLog again(3, StressRecording{dir.path(), first.worst_step()});
  play(again);
  const ExrReader before(dir / "before.exr"), frame(dir / "frame.exr");
  EXPECT_EQ(std::get<int>(*before.attribute("eigenlight.frame")), 4);
  EXPECT_EQ(std::get<int>(*frame.attribute("eigenlight.frame")), 5);
  EXPECT_TRUE(frame.has_layer("noisy"));
  EXPECT_FALSE(read_whole_file(dir / "state.bin").empty());
}

TEST(StressLog, NanIsTheWorstFigure) {
  StressLog log(0);
  log.note(1.0);
  log.note(std::numeric_limits<double>::quiet_NaN(), "nan");
  log.note(1e300);
  EXPECT_EQ(log.worst_what(), "nan");
  EXPECT_FALSE(worst_of(log, 1e308).pass());
}

}  // namespace
}  // namespace eigenlight
