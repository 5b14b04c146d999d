#include "sequences/pages/stage_times.h"

#include <numeric>
#include <utility>

namespace eigenlight {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

PageTable stage_table(const std::vector<StageTimes>& stages) {
  const bool has_cpu = !stages.empty() && !stages.front().cpu_ms.empty();
  PageTable table{"Mean time per frame", "", "stage", {{"wall clock, ms"}}, {}};
  if (has_cpu) table.columns.push_back({"CPU, ms"});
  double wall = 0.0, cpu = 0.0;
  for (const StageTimes& stage : stages) {
    TableRow row{stage.name, {mean(stage.wall_ms)}};
    if (has_cpu) row.cells.push_back(mean(stage.cpu_ms));
    table.rows.push_back(std::move(row));
    wall += mean(stage.wall_ms);
    if (has_cpu) cpu += mean(stage.cpu_ms);
  }
  TableRow all{"all", {wall}, true};
  if (has_cpu) all.cells.push_back(cpu);
  table.rows.push_back(std::move(all));
  return table;
}

PlotSeries series_of(std::string name, const std::vector<int>& frames,
                     const std::vector<double>& values) {
  PlotSeries series{std::move(name), {}};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    series.points.push_back({static_cast<double>(frames[i]), values[i]});
  }
  return series;
}

PagePlot stage_plot(const std::vector<int>& frames, const std::vector<StageTimes>& stages) {
  PagePlot plot{"Time per stage", "", {"frame"}, {"wall clock, ms"}, {}};
  plot.frames = frames;
  plot.is_stacked = true;
  for (const StageTimes& stage : stages) {
    plot.series.push_back(series_of(stage.name, frames, stage.wall_ms));
  }
  return plot;
}

PagePlot new_pixels_plot(const std::vector<int>& frames, const std::vector<double>& percent,
                         std::vector<int> cuts) {
  PagePlot plot{"Pixels without history",
                "A cut may lie beyond the scale.",
                {"frame"},
                {"share of surface pixels, %"},
                {series_of("new pixels", frames, percent)}};
  plot.y.starts_at_zero = true;
  plot.frames = frames;
  plot.off_scale = std::move(cuts);
  return plot;
}

}  // namespace eigenlight
