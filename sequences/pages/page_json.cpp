#include "sequences/pages/page_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "frame/check.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

template <typename T, typename ToJson>
Json to_list(const std::vector<T>& items, const ToJson& to_json) {
  Json list = Json::array();
  for (const T& item : items) list.push_back(to_json(item));
  return list;
}

Json number_json(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json axis_json(const PlotAxis& axis) {
  return {{"label", axis.label}, {"log", axis.is_log}, {"zero", axis.starts_at_zero}};
}

Json series_json(const PlotSeries& series) {
  Json x = Json::array(), y = Json::array(), labels = Json::array(), front = Json::array();
  const auto& points = series.points;
  const bool has_labels =
      std::any_of(points.begin(), points.end(), [](const auto& p) { return !p.label.empty(); });
  const bool has_front =
      std::any_of(points.begin(), points.end(), [](const auto& p) { return p.is_on_front; });
  for (const PlotPoint& point : points) {
    x.push_back(number_json(point.x));
    y.push_back(number_json(point.y));
    if (has_labels) labels.push_back(point.label);
    if (has_front) front.push_back(point.is_on_front);
  }
  return {{"name", series.name}, {"x", x}, {"y", y}, {"labels", labels}, {"front", front}};
}

Json series_by_frame(const PlotSeries& series, const PagePlot& plot) {
  std::map<double, double> values;
  for (const PlotPoint& point : series.points) values[point.x] = point.y;
  Json y = Json::array();
  std::size_t used = 0;
  for (const int frame : plot.frames) {
    const auto found = values.find(frame);
    y.push_back(found == values.end() ? Json() : number_json(found->second));
    used += found == values.end() ? 0 : 1;
  }
  EL_CHECK(used == series.points.size(), "plot '{}': series '{}' has points beside its frames",
           plot.title, series.name);
  return {{"name", series.name}, {"y", y}};
}

Json plot_json(const PagePlot& plot) {
  const auto series = [&](const PlotSeries& one) {
    return plot.frames.empty() ? series_json(one) : series_by_frame(one, plot);
  };
  return {{"title", plot.title},         {"note", plot.note},
          {"x", axis_json(plot.x)},      {"y", axis_json(plot.y)},
          {"stacked", plot.is_stacked},  {"frames", plot.frames},
          {"off_scale", plot.off_scale}, {"series", to_list(plot.series, series)}};
}

Json cell_json(const TableCell& cell) {
  if (const auto* number = std::get_if<double>(&cell)) return number_json(*number);
  const auto* words = std::get_if<std::string>(&cell);
  return words ? Json(*words) : Json();
}

// The best number of a column, or nothing if all are the same.
std::optional<double> best_of(const PageTable& table, std::size_t column) {
  const TableColumn::Best rule = table.columns[column].best;
  if (rule == TableColumn::Best::kNone) return {};
  std::optional<double> low, high;
  for (const TableRow& row : table.rows) {
    const auto* number = std::get_if<double>(&row.cells[column]);
    if (!number) continue;
    low = std::min(low.value_or(*number), *number);
    high = std::max(high.value_or(*number), *number);
  }
  if (low == high) return {};
  return rule == TableColumn::Best::kLowest ? low : high;
}

Json table_json(const PageTable& table) {
  for (const TableRow& row : table.rows) {
    EL_CHECK(row.cells.size() == table.columns.size(), "table '{}': row '{}' has {} cells of {}",
             table.title, row.name, row.cells.size(), table.columns.size());
  }
  Json columns = Json::array();
  std::vector<std::optional<double>> best;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    columns.push_back(table.columns[c].title);
    best.push_back(best_of(table, c));
  }
  Json rows = Json::array();
  for (const TableRow& row : table.rows) {
    Json is_best = Json::array();
    for (std::size_t c = 0; c < best.size(); ++c) {
      const auto* number = std::get_if<double>(&row.cells[c]);
      is_best.push_back(best[c] && number && *number == *best[c]);
    }
    rows.push_back({{"name", row.name},
                    {"total", row.is_total},
                    {"cells", to_list(row.cells, cell_json)},
                    {"best", is_best}});
  }
  return {{"title", table.title},
          {"note", table.note},
          {"names", table.names},
          {"columns", columns},
          {"rows", rows}};
}

Json kind_json(const GalleryKind& kind) {
  return {{"name", kind.name},
          {"note", kind.note},
          {"ramp", kind.ramp},
          {"low", kind.low},
          {"high", kind.high}};
}

Json gallery_json(const PageGallery& gallery) {
  Json tiles = Json::array();
  for (const GalleryTile& tile : gallery.tiles) {
    const auto has_all_frames = [&](const std::vector<std::string>& pictures) {
      return pictures.size() == gallery.frames.size();
    };
    EL_CHECK(tile.pictures.size() == gallery.kinds.size() &&
                 std::all_of(tile.pictures.begin(), tile.pictures.end(), has_all_frames),
             "gallery '{}': tile '{}' does not have one picture for each kind and frame",
             gallery.title, tile.name);
    tiles.push_back({{"name", tile.name}, {"pictures", tile.pictures}});
  }
  return {{"title", gallery.title},
          {"note", gallery.note},
          {"fps", gallery.frames_per_second},
          {"split", gallery.is_split},
          {"width", gallery.extent.width},
          {"height", gallery.extent.height},
          {"frames", gallery.frames},
          {"kinds", to_list(gallery.kinds, kind_json)},
          {"tiles", tiles}};
}

Json section_json(const PageSection& section) {
  return {{"title", section.title},
          {"note", section.note},
          {"plots", to_list(section.plots, plot_json)},
          {"tables", to_list(section.tables, table_json)},
          {"galleries", to_list(section.galleries, gallery_json)}};
}

}  // namespace

Json page_json(const Page& page) {
  return {{"subtitle", page.subtitle},
          {"names", page.names},
          {"background", {{"label", page.background.label}, {"names", page.background.names}}},
          {"sections", to_list(page.sections, section_json)}};
}

}  // namespace eigenlight
