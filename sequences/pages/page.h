// A web page of plots, tables and pictures, in one HTML file that needs no other file.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "frame/plane.h"

namespace eigenlight {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;            ///< NaN or Inf: no point here, and the line has a gap
  std::string label = {};    ///< of this point alone, such as `3 spp`
  bool is_on_front = false;  ///< no other point of the plot is better in both x and y
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;  ///< joined in this order
};

struct PlotAxis {
  std::string label;  ///< with its unit
  bool is_log = false;
  bool starts_at_zero = false;  ///< of a linear axis; else it covers the values only
};

/// A logarithmic axis leaves out points whose value is 0 or less.
struct PagePlot {
  std::string title, note;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  /// Frame numbers in the order of the x axis, if x holds frame numbers, each at most once in a
  /// series; else empty. A frame that a series lacks is a gap. The plot marks the frame in view,
  /// and a click on the plot shows that frame.
  std::vector<int> frames = {};
  bool is_stacked = false;  ///< the series are bars on top of each other; needs `frames`
  /// Frames whose values may lie beyond the upper end of the y axis: they are drawn at that end.
  std::vector<int> off_scale = {};
};

/// One cell of a table: empty, a number or text.
using TableCell = std::variant<std::monostate, double, std::string>;

struct TableColumn {
  enum class Best { kNone, kLowest, kHighest };
  std::string title;        ///< with its unit
  Best best = Best::kNone;  ///< which number of the column is bold
};

struct TableRow {
  std::string name;
  std::vector<TableCell> cells;  ///< one for each column
  bool is_total = false;         ///< the whole row is bold
};

/// Has no head if `names` and all titles of columns are empty.
struct PageTable {
  std::string title, note;
  std::string names;  ///< title of the column that holds the names of the rows
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
};

/// A table of names and values.
[[nodiscard]] PageTable facts_table(std::string title,
                                    const std::vector<std::pair<std::string, std::string>>& facts);

struct GalleryKind {
  std::string name, note;
  std::vector<std::string> ramp = {};  ///< CSS colors of a heat map, from low to high
  std::string low = {}, high = {};     ///< values at both ends of the ramp
};

struct GalleryTile {
  std::string name;
  std::vector<std::vector<std::string>> pictures;  ///< data URIs by kind and frame
};

/// Pictures that show the same frame and kind at a time. They can be played.
struct PageGallery {
  std::string title, note;
  std::vector<int> frames;
  std::vector<GalleryKind> kinds;
  std::vector<GalleryTile> tiles;
  double frames_per_second = 24.0;
  /// Two tiles share one picture, the first left and the second right of a divider that can be
  /// moved. A single tile is shown alone. Otherwise tiles stand side by side.
  bool is_split = false;
  Extent extent = {};  ///< pixels of each picture; read only if is_split
};

/// Shown in this order, each list if it is not empty.
struct PageSection {
  std::string title, note;  ///< either may be empty
  std::vector<PagePlot> plots;
  std::vector<PageTable> tables;
  std::vector<PageGallery> galleries;
};

/// Names that are not what the page is about: they get gray colors, and one check box hides them.
struct PageBackground {
  std::string label;  ///< of the check box: `rendering and files`
  std::vector<std::string> names;
};

struct Page {
  std::string title, subtitle;
  /// Each of these names has the same color and marker in all plots, tables and galleries, and a
  /// button in the legend that hides it in plots.
  std::vector<std::string> names;
  PageBackground background = {};  ///< of `names`
  std::vector<PageSection> sections;
};

/// The page as HTML. All strings of `page` are plain text; bytes that are not UTF-8 are replaced.
/// The page is light or dark as the reader's system is. Left and right step through the frames,
/// space plays. Throws std::invalid_argument naming the table or gallery whose rows or pictures do
/// not match its columns, kinds or frames, or the plot with a point beside its frames.
[[nodiscard]] std::string to_html(const Page& page);

}  // namespace eigenlight
