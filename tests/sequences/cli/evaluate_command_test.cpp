// `eigenlight evaluate` in this process.
#include "sequences/cli/evaluate_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/command_line.h"
#include "tests/support/fake_images.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Runs `evaluate` on the sequences of a fixture and returns its standard output.
std::string run(const EvaluateOptions& options, std::vector<std::string> words) {
  words.insert(words.begin(),
               {"evaluate", "--test", options.test, "--reference", options.reference});
  const Outcome outcome = call(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.out;
}

using EvaluateCommandTest = EvaluateTest;
using EvaluateStepCommandTest = EvaluateStepTest;

TEST_F(EvaluateCommandTest, JsonHoldsMeasuredFiguresOnly) {
  const auto json = nlohmann::json::parse(run(options(), {"--json", "--frames", "1-2"}));
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["per_frame"].size(), 2u);
  EXPECT_NEAR(json["mean"]["relmse"].get<double>(), 0.0625 / 0.26, 1e-9);
  EXPECT_TRUE(json["mean"].contains("ssim"));
  EXPECT_TRUE(json["old"].contains("mse"));
  for (const char* absent : {"ms_ssim", "flicker", "reference_noise_relmse"}) {
    EXPECT_FALSE(json["mean"].contains(absent)) << absent;
  }
  EXPECT_FALSE(json["per_frame"][0].contains("temporal_error"));
  EXPECT_EQ(json["per_frame"][1]["temporal_error"], 0.0);
  EXPECT_FALSE(json["per_frame"][1].contains("tpsnr"));  // infinite
  EXPECT_TRUE(
      nlohmann::json::parse(run(options(), {"--json", "--flicker"}))["mean"].contains("flicker"));
}

TEST_F(EvaluateStepCommandTest, StepOptionMeasuresLag) {
  const auto json = nlohmann::json::parse(run(options(), {"--json", "--step", "5"}));
  EXPECT_EQ(json["step"], 5);
  // 1/2, 3/4, 7/8, 15/16 of it at frames 5 to 8.
  EXPECT_EQ(json["mean"]["lag_frames"], 3);
  const double squares = 1.0 / 64 + 1.0 / 256 + 1.0 / 1024 + 1.0 / 4096;
  EXPECT_NEAR(json["mean"]["lag_error"].get<double>(), squares / 0.26, 1e-9);
  EXPECT_FALSE(json["per_frame"][0].contains("step_reached"));
  EXPECT_NEAR(json["per_frame"][1]["step_reached"].get<double>(), 0.5, 1e-9);
  EXPECT_THAT(run(options(), {"--step", "5"}),
              HasSubstr("lag: 3 frames after the light step at 5"));
}

TEST_F(EvaluateStepCommandTest, UnreachedStepHasNoLag) {
  const std::vector<std::string> early{"--step", "5", "--frames", "4-6"};
  auto words = early;
  words.push_back("--json");
  const auto json = nlohmann::json::parse(run(options(), words));
  EXPECT_FALSE(json["mean"].contains("lag_frames"));
  EXPECT_FALSE(json["mean"].contains("lag_error"));
  EXPECT_NEAR(json["per_frame"][2]["step_reached"].get<double>(), 0.75, 1e-9);
  EXPECT_THAT(run(options(), early), HasSubstr("not 90 % of the light step at 5, 75.0 % at most"));
}

TEST_F(EvaluateCommandTest, PrintsTableAndWritesJson) {
  const std::string table = run(options(), {"-o", (dir_ / "out").string()});
  EXPECT_THAT(table, AllOf(HasSubstr("3 frames; surface from test id"), HasSubstr("relmse"),
                           HasSubstr("sRGB(clamp(1 * value, 0, 1))")));
  std::ifstream file(dir_ / "out" / "evaluate.json");
  EXPECT_EQ(nlohmann::json::parse(file)["frames"], 3);
}

}  // namespace
}  // namespace eigenlight
