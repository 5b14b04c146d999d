// Every quick case of `eigenlight stress`, and the command itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "sequences/cli/stress_command.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/stress/stress_case.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

// Statistics over a thousand seeds take too long here; `eigenlight stress` has them.
std::vector<StressCase> quick_cases() {
  std::vector<StressCase> cases = stress_cases();
  std::erase_if(cases,
                [](const StressCase& c) { return c.is_long || c.name.starts_with("statistics."); });
  return cases;
}

class StressCaseTest : public testing::TestWithParam<StressCase> {};

TEST_P(StressCaseTest, StaysWithinItsBound) {
  Lab lab(0);
  const StressFinding finding = GetParam().run(lab);
  EXPECT_TRUE(finding.pass()) << finding.figure << " against " << finding.bound << " ("
                              << GetParam().what << "; " << finding.where << "): eigenlight stress"
                              << " --case " << GetParam().name;
  EXPECT_GT(lab.steps(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, StressCaseTest, testing::ValuesIn(quick_cases()),
                         [](const auto& stress) {
                           std::string name(stress.param.name);
                           std::replace_if(
                               name.begin(), name.end(),
                               [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
                           return name;
                         });

struct Outcome {
  int status;
  std::string out, err;
};

Outcome run(StressSettings settings) {
  std::ostringstream out, err;
  const int status = stress_command(settings, {out, err, false, ""});
  return {status, out.str(), err.str()};
}

TEST(StressCommand, PrintsATableOrJson) {
  const Outcome table = run({.only = "algebra.black"});
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.out, HasSubstr("algebra.black"));
  EXPECT_THAT(table.out, HasSubstr("1 of 1 cases within their bounds"));
  const auto json = nlohmann::json::parse(run({.json = true, .only = "history"}).out);
  ASSERT_EQ(json["cases"].size(), history_cases().size());
  for (const char* field : {"name", "frames", "figure", "bound", "pass"}) {
    EXPECT_TRUE(json["cases"][0].contains(field)) << field;
  }
}

TEST(StressCommand, NamesTheCasesWhenThereIsNoneOfAName) {
  EXPECT_THAT([] { (void)run({.only = "no.such"}); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::AllOf(HasSubstr("'no.such'"), HasSubstr("values.signal"))));
}

TEST(StressCommand, CaseNamesAreThemeAndCaseAndUnique) {
  std::set<std::string_view> names;
  for (const StressCase& c : stress_cases()) {
    EXPECT_EQ(std::count(c.name.begin(), c.name.end(), '.'), 1) << c.name;
    EXPECT_TRUE(names.insert(c.name).second) << c.name;
    EXPECT_FALSE(c.what.empty());
  }
}

// What a broken case leaves, with a figure that grows to frame 5 of the second run.
TEST(StressRecording, KeepsTheFrameBeforeTheFrameAndTheHistory) {
  const TempDir dir;
  const auto play = [](Lab& lab) {
    for (int run = 0; run < 2; ++run) {
      StressRun frames(lab, {.extent = {9, 7}, .frames = 8});
      while (frames.step()) {
        const int frame = frames.frame().index;
        lab.note(run == 1 && frame <= 5 ? frame : 0.0, "here");
      }
    }
  };
  Lab first(3);
  play(first);
  EXPECT_EQ(first.worst(), 5.0);
  EXPECT_EQ(first.worst_what(), "here");
  EXPECT_EQ(first.worst_step(), 8 + 6);
  Lab again(3, StressRecording{dir.path(), first.worst_step()});
  play(again);
  const ExrReader before(dir / "before.exr"), frame(dir / "frame.exr");
  EXPECT_EQ(std::get<int>(*before.attribute("eigenlight.frame")), 4);
  EXPECT_EQ(std::get<int>(*frame.attribute("eigenlight.frame")), 5);
  EXPECT_TRUE(frame.has_layer("noisy"));
  EXPECT_FALSE(read_whole_file(dir / "state.bin").empty());
}

TEST(Lab, NanIsWorseThanAll) {
  Lab lab(0);
  lab.note(1.0);
  lab.note(std::numeric_limits<double>::quiet_NaN(), "nan");
  lab.note(1e300);
  EXPECT_EQ(lab.worst_what(), "nan");
  EXPECT_FALSE(worst_of(lab, 1e308).pass());
}

}  // namespace
}  // namespace eigenlight
