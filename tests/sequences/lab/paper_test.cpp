// `eigenlight compare --paper`: reports, and what they are made with.
#include "sequences/lab/paper.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sequences/lab/paper_bauszat2011.h"
#include "sequences/lab/paper_chen2012.h"
#include "sequences/lab/paper_chiu2012.h"
#include "sequences/lab/paper_scene.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;

PaperReport small_report() {
  PaperReport report;
  report.claims = {{"Table 1", "fast", "1 ms", "2 ms", Verdict::kInPart}};
  PageTable table{"times", "", "size", {{"ms"}, {"words"}}, {{"8x8", {2.5, std::string("few")}}}};
  PagePlot plot{"error", "", {"frame"}, {"mse", true}, {{"a", {{1.0, 0.5}, {2.0, 0.25}}}}};
  report.sections = {{"Table 1", "", {plot}, {table}, {}}};
  return report;
}

TEST(Paper, PapersAreFoundByName) {
  for (const Paper& paper : papers()) EXPECT_EQ(&find_paper(paper.name), &paper);
  try {
    (void)find_paper("chen2013");
    FAIL() << "no such paper";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("chen2013"), HasSubstr("chen2012")));
  }
}

TEST(Paper, ReportsContainAllFigures) {
  const Paper& paper = papers().front();
  const PaperRun run{{8, 4}, {0, 1, 2}, [](const std::string&) {}};
  const auto json = nlohmann::json::parse(paper_json(paper, run, small_report()));
  EXPECT_EQ(json["paper_hardware"], paper.hardware);
  EXPECT_EQ(json["frames"], "0-2");
  EXPECT_EQ(json["claims"][0]["verdict"], "held in part");
  const auto& section = json["sections"][0];
  EXPECT_EQ(section["tables"][0]["rows"][0]["ms"], 2.5);
  EXPECT_EQ(section["tables"][0]["rows"][0]["words"], "few");
  EXPECT_EQ(section["plots"][0]["series"]["a"][1][1], 0.25);
  EXPECT_THAT(to_markdown(paper, run, small_report()),
              AllOf(HasSubstr("where the paper gives no size, 8x4, frames 0-2"),
                    HasSubstr("| Table 1 | fast | 1 ms | 2 ms | held in part |")));
  EXPECT_THAT(to_html(paper_page(paper, run, small_report())),
              AllOf(HasSubstr("held in part"), HasSubstr("2 ms")));
}

// The first basis is of the steady light: both kinds of PCA have to find it.
TEST(Paper, ChensFirstBasisEqualsThatOfBatchPca) {
  const PaperRun run{{24, 14}, {0, 1, 2, 3, 4, 5, 6, 7}, [](const std::string&) {}};
  PaperReport report;
  chen_bases(run, report);
  ASSERT_EQ(report.claims.size(), 1u);
  const PageTable& table = report.sections.at(0).tables.at(0);
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_GT(std::get<double>(table.rows[0].cells[0]), 0.99);
  for (const TableRow& row : table.rows) EXPECT_LE(std::get<double>(row.cells[0]), 1.0 + 1e-9);
}

const PaperRun kTiny{{32, 18}, {0, 1, 2, 3, 4, 5, 6, 7}, [](const std::string&) {}};

double number(const PageTable& table, std::size_t row, std::size_t column) {
  return std::get<double>(table.rows.at(row).cells.at(column));
}

// With one basis and one weight a pixel seen after 48 frames takes in 3 / 49 of its first frame, so
// that most of its light is missing; with weights of its own it does not.
TEST(Paper, ChensSingleWeightBiasesNewPixels) {
  PaperReport report;
  chen_disocclusion(kTiny, report);
  ASSERT_EQ(report.claims.size(), 1u);
  const auto& series = report.sections.at(0).plots.at(0).series;
  ASSERT_EQ(series.size(), 6u);
  EXPECT_LT(series[0].points.front().y, 0.3);
  EXPECT_GT(series[1].points.front().y, 0.5);
  EXPECT_LT(series[1].points.back().y, 0.5 * series[1].points.front().y);
}

// Filters of any kind take most of the noise out, and the best of the settings tried is shown.
TEST(Paper, BauszatsFiltersAreShownAtTheirBestSetting) {
  PaperReport report;
  bauszat_errors(kTiny, report);
  ASSERT_EQ(report.claims.size(), 7u);
  ASSERT_EQ(report.sections.size(), 3u);
  for (const PageSection& section : report.sections) {
    const PageTable& table = section.tables.at(0);
    ASSERT_EQ(table.rows.size(), 4u);
    for (std::size_t filter = 0; filter < 3; ++filter) {
      EXPECT_LT(number(table, filter + 1, 0), number(table, 0, 0)) << section.title;
      double least = INFINITY;
      for (const PlotPoint& point : section.plots.at(0).series.at(filter).points) {
        least = std::min(least, point.y);
      }
      EXPECT_EQ(number(table, filter + 1, 0), least);
    }
  }
}

// Rows: 1 bounce and 1 sample, 1 and 4, 2 and 4. Large enough that the rays outweigh all else.
TEST(Paper, BauszatsRenderingTimesGrowWithSamplesAndBounces) {
  const PaperRun run{{160, 90}, {0}, [](const std::string&) {}};
  PaperReport report;
  bauszat_rendering_times(run, report);
  ASSERT_EQ(report.claims.size(), 2u);
  const PageTable& table = report.sections.at(0).tables.at(0);
  const double one = number(table, 0, 3), four = number(table, 1, 3), twice = number(table, 2, 3);
  EXPECT_GT(four, 1.5 * one);
  EXPECT_GT(twice, 1.1 * four);
  EXPECT_EQ(report.claims[0].ours, fmt::format("{:.2f}", four / one));
  EXPECT_EQ(report.claims[0].verdict, four <= 4.4 * one ? Verdict::kHeld : Verdict::kNot);
  EXPECT_EQ(report.claims[1].ours, fmt::format("{:.2f}", twice / four));
  EXPECT_EQ(report.claims[1].verdict, twice < 2.0 * four ? Verdict::kHeld : Verdict::kNot);
}

TEST(Paper, ChiusErrorsHaveARowPerMode) {
  PaperReport report;
  chiu_errors(kTiny, report);
  ASSERT_EQ(report.claims.size(), 2u);
  const PageTable& table = report.sections.at(0).tables.at(0);
  ASSERT_EQ(table.rows.size(), 4u);
  // The atrium is full of edges: without antialiasing their error is there whatever the noise.
  EXPECT_GT(number(table, 0, 2), 0.0);
  EXPECT_LT(number(table, 3, 2), number(table, 0, 2));
  EXPECT_NE(number(table, 3, 2), number(table, 2, 2));
}

TEST(PaperScene, CameraRestsOrFlies) {
  const Extent extent{24, 16};
  using View = PaperScene::View;
  for (const View view : {View::kAtRest, View::kFlight}) {
    const PaperScene scene("cornell", Perturbation::kNone, extent, view);
    const std::vector<Frame> frames = scene.render(1, {0, 12});
    EXPECT_EQ(frames[0].camera.eye == frames[1].camera.eye, view == View::kAtRest);
  }
}

TEST(PaperScene, MethodsRunOnTheRenderedFrames) {
  const PaperScene scene("cornell", Perturbation::kNone, {24, 16});
  const std::vector<Frame> frames = scene.render(2, {0, 1});
  const auto noisy = make_denoiser("noisy", {{24, 16}, 1});
  const std::vector<Planes<3>> pictures = run_method(scene, *noisy, frames);
  ASSERT_EQ(pictures.size(), 2u);
  const Planes<3> shown = scene.shown(frames[1], frames[1].lights[0].radiance);
  EXPECT_EQ(mean_square(pictures[1], shown, shown, frames[1].surface.id), 0.0);
  EXPECT_GT(mean_square(pictures[0], shown, shown, frames[1].surface.id), 0.0);
}

// (x - a)(x - b) over the mask alone: (2 - 1)(2 - 0) = 2 in each channel.
TEST(PaperScene, MeanSquareIsFreeOfReferenceNoise) {
  Planes<3> x = make_planes<3>({4, 2}), a = make_planes<3>({4, 2}), b = make_planes<3>({4, 2});
  Plane<std::uint32_t> mask({4, 2});
  mask(1, 1) = 7;
  for (std::size_t c = 0; c < 3; ++c) {
    x[c].fill(9.0f);
    x[c](1, 1) = 2.0f;
    a[c](1, 1) = 1.0f;
  }
  EXPECT_EQ(mean_square(x, a, b, mask), 2.0);
  mask(1, 1) = 0;
  EXPECT_EQ(mean_square(x, a, b, mask), 0.0);
}

}  // namespace
}  // namespace eigenlight
