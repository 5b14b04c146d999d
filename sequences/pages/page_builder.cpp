#include "sequences/pages/page_builder.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "frame/check.h"
#include "sequences/pages/page_files.h"
#include "sequences/pages/page_template.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PlotSeries& series);
Json to_json(const PagePlot& plot);
Json to_json(const TableCell& cell);
Json to_json(const PageTable& table);
Json to_json(const GalleryKind& kind);
Json to_json(const PageGallery& gallery);
Json to_json(const PageSection& section);

template <typename T>
Json to_list(const std::vector<T>& items) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(to_json(item));
  return list;
}

Json to_json(const PlotSeries& series) {
  Json points = Json::array();
  for (const PlotPoint& point : series.points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) continue;
    points.push_back(
        {{"x", point.x}, {"y", point.y}, {"label", point.label}, {"front", point.is_on_front}});
  }
  return {{"name", series.name}, {"points", points}};
}

Json to_json(const PlotAxis& axis) { return {{"label", axis.label}, {"log", axis.is_log}}; }

Json to_json(const PagePlot& plot) {
  return {{"title", plot.title},           {"note", plot.note},
          {"x", to_json(plot.x)},          {"y", to_json(plot.y)},
          {"frames", plot.is_over_frames}, {"series", to_list(plot.series)}};
}

Json to_json(const TableCell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) {
    return std::isfinite(*number) ? Json(*number) : Json();
  }
  const auto* words = std::get_if<std::string>(&cell);
  return words ? Json(*words) : Json();
}

// Rows whose number is the best of the column; none where all are the same.
std::vector<bool> best_of(const PageTable& table, std::size_t column) {
  const TableColumn::Best rule = table.columns[column].best;
  std::vector<bool> is_best(table.rows.size(), false);
  if (rule == TableColumn::Best::kNone) return is_best;
  std::optional<double> best, worst;
  const auto number = [&](std::size_t row) {
    return std::get_if<double>(&table.rows[row].cells[column]);
  };
  const auto better = [&](double a, double b) {
    return rule == TableColumn::Best::kLowest ? a < b : a > b;
  };
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (!number(row)) continue;
    if (!best || better(*number(row), *best)) best = *number(row);
    if (!worst || better(*worst, *number(row))) worst = *number(row);
  }
  if (best == worst) return is_best;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    is_best[row] = best && number(row) && *number(row) == *best;
  }
  return is_best;
}

Json to_json(const PageTable& table) {
  Json columns = Json::array(), rows = Json::array();
  for (const TableRow& row : table.rows) {
    EL_CHECK(row.cells.size() == table.columns.size(), "table '{}': row '{}' has {} cells of {}",
             table.title, row.name, row.cells.size(), table.columns.size());
    rows.push_back({{"name", row.name}, {"cells", to_list(row.cells)}, {"best", Json::array()}});
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    columns.push_back(table.columns[c].title);
    const std::vector<bool> is_best = best_of(table, c);
    for (std::size_t r = 0; r < is_best.size(); ++r) rows[r]["best"].push_back(bool(is_best[r]));
  }
  return {{"title", table.title},
          {"note", table.note},
          {"names", table.names},
          {"columns", columns},
          {"rows", rows}};
}

Json to_json(const GalleryKind& kind) {
  return {{"name", kind.name},
          {"note", kind.note},
          {"ramp", kind.ramp},
          {"low", kind.low},
          {"high", kind.high}};
}

Json to_json(const PageGallery& gallery) {
  Json tiles = Json::array();
  for (const GalleryTile& tile : gallery.tiles) {
    bool matches = tile.pictures.size() == gallery.kinds.size();
    for (const auto& pictures : tile.pictures) {
      matches = matches && pictures.size() == gallery.frames.size();
    }
    EL_CHECK(matches, "gallery '{}': tile '{}' does not have one picture a kind and frame",
             gallery.title, tile.name);
    tiles.push_back({{"name", tile.name}, {"pictures", tile.pictures}});
  }
  return {{"title", gallery.title},
          {"note", gallery.note},
          {"frames", gallery.frames},
          {"kinds", to_list(gallery.kinds)},
          {"tiles", tiles}};
}

Json to_json(const PageSection& section) {
  return {{"title", section.title},
          {"note", section.note},
          {"plots", to_list(section.plots)},
          {"tables", to_list(section.tables)},
          {"galleries", to_list(section.galleries)}};
}

}  // namespace

std::string to_html(const Page& page) {
  const Json data{{"subtitle", page.subtitle},
                  {"summary", page.summary},
                  {"names", page.names},
                  {"sections", to_list(page.sections)}};
  return fill_page({kBuilderHtml, kBuilderCss, kBuilderJs}, page.title, data);
}

}  // namespace eigenlight
