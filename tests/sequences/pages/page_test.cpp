#include "sequences/pages/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sequences/pages/page_json.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

Page page_with(PageSection section) {
  Page page;
  page.sections.push_back(std::move(section));
  return page;
}

auto throws_naming(const char* what) {
  return ThrowsMessage<std::invalid_argument>(HasSubstr(what));
}

TEST(Page, IsOneFileWhoseTextIsNeverMarkup) {
  Page page = page_with({"one", "", {}, {facts_table("facts", {{"</script>", "1"}})}, {}});
  page.title = "a <b> & \"c\"";
  const std::string html = to_html(page);
  EXPECT_THAT(html, HasSubstr("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
  EXPECT_THAT(html, HasSubstr("\\u003c/script>"));
  EXPECT_THAT(html, AllOf(Not(HasSubstr("{{")), Not(HasSubstr("src=\"http"))));
}

TEST(Page, ReplacesBytesThatAreNotUtf8) {
  EXPECT_THAT(to_html(page_with({"\xff", "", {}, {}, {}})), HasSubstr("\xef\xbf\xbd"));
}

TEST(Page, RefusesRowsThatDoNotMatchTheColumns) {
  PageTable table{"ragged", "", "name", {{"x"}, {"y"}}, {{"row", {1.0}}}};
  EXPECT_THAT(
      [&] {
        (void)to_html(page_with({"", "", {}, {table}, {}}));
      },
      throws_naming("table 'ragged'"));
}

TEST(Page, RefusesATileThatLacksAPicture) {
  PageGallery gallery{"short", "", {1, 2}, {{"crop", ""}}, {{"tile", {{"uri"}}}}};
  EXPECT_THAT(
      [&] {
        (void)to_html(page_with({"", "", {}, {}, {gallery}}));
      },
      throws_naming("gallery 'short'"));
}

TEST(Page, PutsTheValuesOfAPlotOverFramesInTheOrderOfTheFrames) {
  PagePlot plot{"error", "", {"frame"}, {"mse"}, {}};
  plot.frames = {7, 5, 3};
  plot.series = {{"a", {{3.0, 0.3}, {7.0, 0.7}}}, {"b", {{5.0, std::nan("")}}}};
  const auto json = page_json(page_with({"", "", {plot}, {}, {}}))["sections"][0]["plots"][0];
  EXPECT_EQ(json["series"][0]["y"].dump(), "[0.7,null,0.3]");
  EXPECT_EQ(json["series"][1]["y"].dump(), "[null,null,null]");
  plot.series[0].points[0].x = 4.0;
  EXPECT_THAT(
      [&] {
        (void)to_html(page_with({"", "", {plot}, {}, {}}));
      },
      throws_naming("plot 'error': series 'a'"));
}

// The best number of each column, as the page gets it.
std::string best_cells(const PageTable& table) {
  const auto json = page_json(page_with({"", "", {}, {table}, {}}))["sections"][0]["tables"][0];
  std::string text;
  for (const auto& row : json["rows"]) text += row["best"].dump();
  return text;
}

TEST(Page, MarksTheBestNumberOfAColumn) {
  using Best = TableColumn::Best;
  PageTable table{"t", "", "name", {{"low", Best::kLowest}, {"high", Best::kHighest}, {"no"}}, {}};
  table.rows = {{"a", {1.0, 1.0, 1.0}}, {"b", {2.0, 2.0, 2.0}}, {"c", {{}, std::string("9"), {}}}};
  EXPECT_EQ(best_cells(table), "[true,false,false][false,true,false][false,false,false]");
  table.rows[1].cells[0] = 1.0;
  EXPECT_EQ(best_cells(table), "[false,false,false][false,true,false][false,false,false]")
      << "equal numbers are not marked";
}

}  // namespace
}  // namespace eigenlight
