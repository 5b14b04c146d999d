// Tables, CSV and JSON of a made-up comparison.
#include "sequences/compare/compare_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sequences/compare/compare_page.h"
#include "tests/support/fake_comparison.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CompareResults, EqualTimeIsThatOfOursAtItsLowestCount) {
  const ComparePlan plan = fake_plan({1, 2, 4});
  const CaseResults results = fake_results(plan, "room");
  const EqualTime equal = equal_time(plan, results);
  const Cell& lowest = *results.find("eigenlight", 1);
  EXPECT_EQ(equal.ms, lowest.total_ms());
  EXPECT_EQ(equal.relmse.at("eigenlight"), lowest.mean()[0][Metric::kRelmse]);
  const double low = *results.find("mean", 1)->mean()[0][Metric::kRelmse];
  const double high = *results.find("mean", 2)->mean()[0][Metric::kRelmse];
  ASSERT_TRUE(equal.relmse.at("mean"));
  EXPECT_LT(*equal.relmse.at("mean"), low);
  EXPECT_GT(*equal.relmse.at("mean"), high);
}

TEST(CompareResults, EqualTimeIsAbsentWhereItWouldBeExtrapolated) {
  ComparePlan plan = fake_plan({1, 2, 4});
  plan.equal_time = 1e6;
  const CaseResults results = fake_results(plan, "room");
  EXPECT_FALSE(equal_time(plan, results).relmse.at("mean"));
  const auto json = to_json(plan, {results});
  EXPECT_EQ(json["scenes"][0]["equal_time"]["ms"], 1e6);
  EXPECT_TRUE(json["scenes"][0]["equal_time"]["relmse"].empty());
}

TEST(CompareResults, JsonHoldsSettingsMachineAndCells) {
  const ComparePlan plan = fake_plan({1, 3});
  const auto json = to_json(plan, {fake_results(plan, "room")});
  EXPECT_THAT(json["software"].get<std::string>(), HasSubstr("eigenlight "));
  EXPECT_GT(json["machine"]["cores"], 0);
  EXPECT_EQ(json["settings"]["frames"], "4-6");
  EXPECT_EQ(json["settings"]["seed"], 0);
  const auto& cells = json["scenes"][0]["cells"];
  ASSERT_EQ(cells.size(), 2 * plan.contenders.size());
  EXPECT_EQ(cells[0]["contender"], "eigenlight");
  EXPECT_EQ(cells[0]["per_frame"].size(), 3u);
  EXPECT_GT(cells[0]["mean"]["relmse"], 0.0);
  EXPECT_DOUBLE_EQ(cells[0]["mean"]["energy"].get<double>(), 0.98);
  EXPECT_FALSE(cells[0]["per_frame"][0].contains("temporal_error"))
      << "the first frame has none before it: absent, not 0";
  EXPECT_EQ(
      cells[0]["cpu_ms"]["total"].get<double>(),
      cells[0]["cpu_ms"]["render"].get<double>() + cells[0]["cpu_ms"]["denoise"].get<double>());
}

TEST(CompareResults, CsvHasALineForEachCell) {
  const ComparePlan plan = fake_plan({1, 3});
  CaseResults results = fake_results(plan, "room");
  results.cells[0].frames[0].sets[1] = {};
  for (FrameFigures& frame : results.cells[0].frames) frame.sets[1].values = {};
  const std::string csv = to_csv({results});
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < csv.size();) {
    const std::size_t end = csv.find('\n', at);
    lines.push_back(csv.substr(at, end - at));
    at = end + 1;
  }
  ASSERT_EQ(lines.size(), 1 + results.cells.size());
  for (const std::string& line : lines) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 15) << line;
    EXPECT_THAT(line, Not(HasSubstr("nan")));
  }
  EXPECT_THAT(lines[1], HasSubstr("room,eigenlight,1,"));
  EXPECT_THAT(lines[1], HasSubstr(",,")) << "what was not measured is empty";
}

TEST(CompareResults, CellsComeBackFromTheirStore) {
  const TempDir dir;
  const ComparePlan plan = fake_plan({1});
  const Cell cell = fake_results(plan, "room").cells[1];
  const CellStore store(dir / "cells", {{"program", 1}});
  EXPECT_FALSE(store.load({{"spp", 1}}));
  store.save({{"spp", 1}}, cell);
  const auto found = store.load({{"spp", 1}});
  ASSERT_TRUE(found);
  EXPECT_EQ(to_json(*found), to_json(cell));
  EXPECT_FALSE(store.load({{"spp", 2}}));
  EXPECT_FALSE(CellStore(dir / "cells", {{"program", 2}}).load({{"spp", 1}}));
  for (const auto& file : std::filesystem::directory_iterator(dir / "cells")) {
    std::filesystem::resize_file(file.path(), 100);
  }
  EXPECT_FALSE(store.load({{"spp", 1}})) << "half a file is none";
}

TEST(ComparePage, HasASectionForEachSceneAndARowForEachPart) {
  ComparePlan plan = fake_plan({1, 3});
  plan.contenders.push_back({"eigenlight-without-budget", "eigenlight", "budget", {}});
  const std::vector<CaseResults> results{fake_results(plan, "room"), fake_results(plan, "hall")};
  const Page page = compare_page(plan, results, {fake_gallery(plan), fake_gallery(plan)});
  ASSERT_EQ(page.sections.size(), 3u) << "two scenes and the setup";
  EXPECT_EQ(page.names.size(), plan.contenders.size());
  const PageSection& section = page.sections[0];
  EXPECT_EQ(section.title, "room");
  ASSERT_EQ(section.plots.size(), 3u);
  EXPECT_EQ(section.plots[0].series.size(), plan.contenders.size());
  EXPECT_EQ(section.plots[0].series[0].points.size(), 2u);
  ASSERT_EQ(section.tables.size(), 2u);
  ASSERT_EQ(section.tables[1].rows.size(), 2u);
  EXPECT_EQ(std::get<double>(section.tables[1].rows[0].cells[1]), 1.0);
  EXPECT_EQ(section.tables[1].rows[1].name, "eigenlight-without-budget");
  EXPECT_THROW((void)compare_page(plan, results, {}), std::invalid_argument);
}

TEST(ComparePage, TheFrontHoldsNoPointThatIsBeaten) {
  const ComparePlan plan = fake_plan({1, 2, 4});
  const Page page = compare_page(plan, {fake_results(plan, "room")}, {fake_gallery(plan)});
  std::vector<PlotPoint> points;
  for (const PlotSeries& series : page.sections[0].plots[0].series) {
    points.insert(points.end(), series.points.begin(), series.points.end());
  }
  for (const PlotPoint& a : points) {
    const bool is_beaten = std::any_of(points.begin(), points.end(), [&](const PlotPoint& b) {
      return b.x <= a.x && b.y <= a.y && (b.x < a.x || b.y < a.y);
    });
    EXPECT_NE(a.is_on_front, is_beaten);
  }
}

}  // namespace
}  // namespace eigenlight
