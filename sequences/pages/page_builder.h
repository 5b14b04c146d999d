// Pages of plots, tables and pictures, for results of any kind.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace eigenlight {

struct PlotPoint {
  double x = 0.0, y = 0.0;
  std::string label = {};    ///< of the point alone, such as `3 spp`
  bool is_on_front = false;  ///< no other point of the plot is better in both x and y
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;  ///< joined in this order
};

struct PlotAxis {
  std::string label;  ///< with its unit
  bool is_log = false;
};

/// Points at values <= 0 of a logarithmic axis are left out.
struct PagePlot {
  std::string title, note;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  bool is_over_frames = false;  ///< x are frame numbers: the frame in view is marked, a click seeks
};

/// What a table holds: nothing, a number or words.
using TableCell = std::variant<std::monostate, double, std::string>;

struct TableColumn {
  enum class Best { kNone, kLowest, kHighest };
  std::string title;        ///< with its unit
  Best best = Best::kNone;  ///< which of its numbers is bold
};

struct TableRow {
  std::string name;
  std::vector<TableCell> cells;  ///< one for each column
};

struct PageTable {
  std::string title, note;
  std::string names;  ///< heading of the rows' names
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
};

struct GalleryKind {
  std::string name, note;
  std::vector<std::string> ramp = {};  ///< colors of a heat map, low to high, as CSS has them
  std::string low = {}, high = {};     ///< what its ends stand for
};

struct GalleryTile {
  std::string name;
  std::vector<std::vector<std::string>> pictures;  ///< data URI by kind and frame
};

/// Pictures side by side, one for each name, all of one frame and kind at a time.
struct PageGallery {
  std::string title, note;
  std::vector<int> frames;
  std::vector<GalleryKind> kinds;
  std::vector<GalleryTile> tiles;
};

struct PageSection {
  std::string title, note;
  std::vector<PagePlot> plots;
  std::vector<PageTable> tables;
  std::vector<PageGallery> galleries;
};

struct Page {
  std::string title, subtitle;
  std::vector<std::pair<std::string, std::string>> summary;  ///< name and value
  /// Names with a color and a marker of their own, the same wherever they stand; in this order.
  std::vector<std::string> names;
  std::vector<PageSection> sections;
};

/// One HTML page without any other file or network. All strings are plain text. Light and dark as
/// the reader's system is; left and right step through the frames. Throws std::invalid_argument
/// naming the table or gallery whose rows or pictures do not match its columns or frames.
[[nodiscard]] std::string to_html(const Page& page);

}  // namespace eigenlight
