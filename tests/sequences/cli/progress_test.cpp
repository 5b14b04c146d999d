#include "sequences/cli/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

TEST(Progress, DurationsArePrintedInTwoUnits) {
  EXPECT_EQ(format_duration(0.4), "0s");
  EXPECT_EQ(format_duration(59.0), "59s");
  EXPECT_EQ(format_duration(185.0), "3m05s");
  EXPECT_EQ(format_duration(7800.0), "2h10m");
  EXPECT_EQ(format_duration(-1.0), "?");
  EXPECT_EQ(format_duration(std::numeric_limits<double>::quiet_NaN()), "?");
  EXPECT_EQ(format_duration(std::numeric_limits<double>::infinity()), "?");
}

TEST(Progress, PipeGetsOneLinePerFrame) {
  std::ostringstream out;
  {
    Progress progress(out, Progress::Style::kLines, 2, 4);
    progress.frame_done(12);
    progress.frame_done(13);
  }
  EXPECT_THAT(out.str(), MatchesRegex("frame 12  3/4  [^\n]*left\nframe 13  4/4  [^\n]*0s left\n"));
}

TEST(Progress, TerminalLineIsRedrawnInPlace) {
  std::ostringstream out;
  {
    Progress progress(out, Progress::Style::kBar, 0, 2);
    progress.frame_done(0);
    EXPECT_THAT(out.str(), HasSubstr("\r[############------------] frame 0  1/2"));
    progress.frame_done(1);
  }
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 2);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_EQ(text.back(), '\n');
}

TEST(Progress, QuietStylePrintsNothing) {
  std::ostringstream out;
  {
    Progress progress(out, Progress::Style::kNone, 0, 2);
    progress.frame_done(0);
  }
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace eigenlight
