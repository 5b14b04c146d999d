// The Markdown tables of a made-up comparison.
#include "sequences/compare/compare_markdown.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_comparison.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(CompareMarkdown, MultiplesEnergyAndTemporalErrorStandBesideEveryRelmse) {
  const ComparePlan plan = fake_plan({3});
  const std::string text = to_markdown(plan, {fake_results(plan, "room")});
  EXPECT_THAT(text, HasSubstr("96x54, frames 4-6 after 4 of history, two independent references of "
                              "64 samples each"));
  EXPECT_THAT(text, HasSubstr("| scene | spp | method | relMSE | / noisy | energy | temporal error "
                              "| / noisy | MSE | extra spp | render ms | denoise ms |\n"));
  // `noisy` is sixteen times as bad as `eigenlight`, and as bright.
  EXPECT_THAT(text, HasSubstr("| room | 3 | `eigenlight` | 0.005 | 0.0625 | 0.9800 | 0.000333 | "
                              "0.0625 | 0.000667 | 0 | 300 | 40 |\n"));
  EXPECT_THAT(text, HasSubstr("| room | 3 | `noisy` | 0.08 | 1.0000 | 15.6800 |"));
  EXPECT_THAT(text, Not(HasSubstr("same total CPU time"))) << "there is one sample count only";
}

TEST(CompareMarkdown, WithoutABaselineThereAreNoMultiples) {
  ComparePlan plan = fake_plan({3});
  plan.contenders.pop_back();
  EXPECT_THAT(to_markdown(plan, {fake_results(plan, "room")}),
              AllOf(HasSubstr("| relMSE | energy | temporal error | MSE |"),
                    HasSubstr("| room | 3 | `mean` | 0.02 | 3.9200 |")));
}

TEST(CompareMarkdown, EnergiesOfSeveralScenesStandSideBySide) {
  const ComparePlan plan = fake_plan({3});
  const std::string text =
      to_markdown(plan, {fake_results(plan, "room"), fake_results(plan, "hall")});
  EXPECT_THAT(text, AllOf(HasSubstr("| energy, 3 spp | room | hall |\n"),
                          HasSubstr("| `eigenlight` | 0.9800 | 0.9800 |\n")));
}

TEST(CompareMarkdown, TheBestErrorAtEqualTimeIsBold) {
  ComparePlan plan = fake_plan({1, 2, 4});
  plan.equal_time = 240.0;  // rendering takes 100 ms a sample, denoising at most 40
  const std::string text = to_markdown(plan, {fake_results(plan, "room")});
  EXPECT_THAT(text, AllOf(HasSubstr("| relMSE at | ms | `eigenlight` | `mean` | `noisy` |\n"),
                          HasSubstr("| room | 240 | **0.0075** | 0.0")));
  plan.equal_time = 1e6;
  EXPECT_THAT(to_markdown(plan, {fake_results(plan, "room")}),
              HasSubstr("| room | 1000000 | - | - | - |\n"));
}

TEST(CompareMarkdown, PartsStandBesideTheWhole) {
  ComparePlan plan = fake_plan({3});
  plan.contenders.push_back({"eigenlight-without-x", "eigenlight", "x", {}});
  EXPECT_THAT(
      to_markdown(plan, {fake_results(plan, "room")}),
      AllOf(HasSubstr("| all parts | 0.005 (1.00) | 0.9800 | 0.000333 (1.00) | 40.0 (1.00) |"),
            HasSubstr("| without `x` | 0.32 (64.00) | 62.7200 | 0.0213 (64.00) | 0.6 (0.02) |")));
}

TEST(CompareMarkdown, AntialiasingShowsItsOwnCosts) {
  ComparePlan plan = fake_plan({24});
  plan.contenders.resize(2);
  plan.contenders[0] = {"none", "", "", {}, AntialiasOptions{}};
  plan.contenders[1] = {"sraa", "", "", {}, AntialiasOptions{AntialiasMode::kSraa, 1}};
  CaseResults results = fake_results(plan, "room");
  results.cells[0].antialias = AntialiasCost{0.0, 5000.0, 0.0};
  results.cells[1].antialias = AntialiasCost{100.0, 5000.0, 0.0125};
  const std::string text = to_markdown(plan, {results});
  EXPECT_THAT(text, AllOf(HasSubstr("| scene | spp | antialiasing | relMSE | / none | energy |"),
                          HasSubstr("against supersample:16 with"),
                          HasSubstr("| antialias ms | rest of the frame ms | supersample:16 / "
                                    "antialias | supersample:16 / frame | unmatched |\n")));
  EXPECT_THAT(text, HasSubstr("| 0 | 2440 | - | 2.0 | 0.0000 |\n"));
  EXPECT_THAT(text, HasSubstr("| 100 | 2410 | 50.0 | 2.0 | 0.0125 |\n"));
}

}  // namespace
}  // namespace eigenlight
