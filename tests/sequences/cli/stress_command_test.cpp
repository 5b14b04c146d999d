// `eigenlight stress` in this process.
#include "sequences/cli/stress_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sequences/files/atomic_file.h"
#include "sequences/files/machine.h"
#include "sequences/files/version.h"
#include "sequences/stress/stress_case.h"
#include "tests/support/command_line.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(StressCommand, PrintsTable) {
  const Outcome table = call({"stress", "--case", "algebra.black"});
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("algebra.black"), HasSubstr("1 of 1 cases within their bounds")));
}

TEST(StressCommand, PrintsJsonOfOneTheme) {
  const auto json = nlohmann::json::parse(call({"stress", "--json", "--case", "history"}).out);
  ASSERT_EQ(json["cases"].size(), history_cases().size());
  for (const char* field : {"name", "frames", "figure", "bound", "pass"}) {
    EXPECT_TRUE(json["cases"][0].contains(field)) << field;
  }
}

TEST(StressCommand, WritesMarkdownBelowAHeadWithDateAndMachine) {
  const TempDir dir;
  const std::string file = dir / "robustness.md";
  ASSERT_EQ(call({"stress", "--case", "algebra.black", "--markdown", file}).status, 0);
  EXPECT_THAT(
      read_whole_file(file),
      AllOf(StartsWith("# Robustness\n"), HasSubstr("| date | " + today() + " |"),
            HasSubstr("| command | `eigenlight stress --case algebra.black --markdown FILE` |"),
            HasSubstr("| program | " + program_version() + " |"),
            HasSubstr("| machine | " + to_text(this_machine()) + " |"),
            HasSubstr("| result | 1 of 1 cases within their bounds, in 0.0 minutes |"),
            HasSubstr("| `algebra.black` | frames without light: largest output value | 20 | "
                      "0 | 0 | yes |\n")));
}

TEST(StressCommand, UnknownCaseListsKnownCases) {
  const Outcome unknown = call({"stress", "--case", "no.such"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, AllOf(HasSubstr("'no.such'"), HasSubstr("values.signal")));
}

}  // namespace
}  // namespace eigenlight
