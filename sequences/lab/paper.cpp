#include "sequences/lab/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "frame/named.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/machine.h"
#include "sequences/files/markdown.h"
#include "sequences/files/version.h"
#include "sequences/lab/paper_reruns.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json cell_json(const TableCell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return *number;
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  return nullptr;
}

Json table_json(const PageTable& table) {
  Json json = {{"title", table.title}, {"note", table.note}, {"rows", Json::array()}};
  for (const TableRow& row : table.rows) {
    Json one = {{table.names, row.name}};
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      one[table.columns[i].title] = cell_json(row.cells[i]);
    }
    json["rows"].push_back(std::move(one));
  }
  return json;
}

Json plot_json(const PagePlot& plot) {
  Json json = {
      {"title", plot.title}, {"x", plot.x.label}, {"y", plot.y.label}, {"series", Json::object()}};
  for (const PlotSeries& series : plot.series) {
    Json points = Json::array();
    for (const PlotPoint& point : series.points) points.push_back({point.x, point.y});
    json["series"][series.name] = std::move(points);
  }
  return json;
}

std::string size_text(const PaperRun& run) {
  return fmt::format("{}x{}, frames {}", run.extent.width, run.extent.height,
                     format_frame_range(run.frames));
}

PageSection claims_section(const Paper& paper, const PaperReport& report) {
  PageTable table{"What the paper claims",
                  fmt::format("The paper measured on: {}.", paper.hardware),
                  "where",
                  {{"claim"}, {"the paper"}, {"here"}, {"verdict"}},
                  {}};
  for (const PaperClaim& claim : report.claims) {
    table.rows.push_back(
        {claim.where,
         {claim.claim, claim.theirs, claim.ours, std::string(to_text(claim.verdict))}});
  }
  PageSection section{"Claims", "", {}, {}, {}};
  section.tables.push_back(std::move(table));
  return section;
}

PageSection setup_section(const Paper& paper, const PaperRun& run) {
  const Machine machine = this_machine();
  PageSection section{"Setup", "", {}, {}, {}};
  section.tables = {facts_table(
      "Machine and settings",
      {{"hardware of the paper", std::string(paper.hardware)},
       {"processor here", fmt::format("{}, {} cores", machine.processor, machine.cores)},
       {"software", program_version() + ", " + machine.compiler},
       {"size and frames here", size_text(run)}})};
  return section;
}

}  // namespace

std::string_view to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHeld:
      return "held";
    case Verdict::kInPart:
      return "held in part";
    case Verdict::kNot:
      return "not";
  }
  throw std::logic_error("a verdict without words");
}

const std::vector<Paper>& papers() {
  static const std::vector<Paper> kPapers{
      chen2012(),
      bauszat2011(),
      chiu2012(),
      xu2024(),
  };
  return kPapers;
}

std::string paper_names() { return names_of(papers()); }

const Paper& find_paper(std::string_view name) { return find_named(papers(), name, "paper"); }

Page paper_page(const Paper& paper, const PaperRun& run, const PaperReport& report) {
  Page page;
  page.title = fmt::format("{}: the figures of the paper and ours", paper.name);
  page.subtitle = paper.title;
  page.sections.push_back(claims_section(paper, report));
  std::set<std::string> seen;
  for (const PageSection& section : report.sections) {
    page.sections.push_back(section);
    for (const PagePlot& plot : section.plots) {
      for (const PlotSeries& series : plot.series) {
        if (seen.insert(series.name).second) page.names.push_back(series.name);
      }
    }
  }
  page.sections.push_back(setup_section(paper, run));
  return page;
}

std::string to_markdown(const Paper& paper, const PaperRun& run, const PaperReport& report) {
  std::vector<std::vector<std::string>> rows;
  for (const PaperClaim& claim : report.claims) {
    rows.push_back(
        {claim.where, claim.claim, claim.theirs, claim.ours, std::string(to_text(claim.verdict))});
  }
  const std::vector<std::string> head{std::string(paper.name), "claim", "the paper", "here", ""};
  return fmt::format("{} (theirs: {}; here, where the paper gives no size, {}):\n\n", paper.title,
                     paper.hardware, size_text(run)) +
         markdown_table(head, rows, head.size());
}

std::string paper_json(const Paper& paper, const PaperRun& run, const PaperReport& report) {
  Json json = {{"paper", paper.name},
               {"title", paper.title},
               {"paper_hardware", paper.hardware},
               {"software", program_version()},
               {"machine", to_json(this_machine())},
               {"size", {run.extent.width, run.extent.height}},
               {"frames", format_frame_range(run.frames)},
               {"claims", Json::array()},
               {"sections", Json::array()}};
  for (const PaperClaim& claim : report.claims) {
    json["claims"].push_back({{"where", claim.where},
                              {"claim", claim.claim},
                              {"paper", claim.theirs},
                              {"ours", claim.ours},
                              {"verdict", to_text(claim.verdict)}});
  }
  for (const PageSection& section : report.sections) {
    Json one = {{"title", section.title}, {"tables", Json::array()}, {"plots", Json::array()}};
    for (const PageTable& table : section.tables) one["tables"].push_back(table_json(table));
    for (const PagePlot& plot : section.plots) one["plots"].push_back(plot_json(plot));
    json["sections"].push_back(std::move(one));
  }
  return json.dump(1) + "\n";
}

}  // namespace eigenlight
