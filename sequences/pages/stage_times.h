// Times of the stages of a run, as a table and as a plot over its frames.
#pragma once

#include <string>
#include <vector>

#include "sequences/pages/page.h"

namespace eigenlight {

struct StageTimes {
  std::string name;
  std::vector<double> wall_ms;  ///< by frame
  std::vector<double> cpu_ms;   ///< by frame; empty: not measured, for all stages alike
};

/// Means over the frames and their sum.
[[nodiscard]] PageTable stage_table(const std::vector<StageTimes>& stages);

/// One point a frame.
[[nodiscard]] PlotSeries series_of(std::string name, const std::vector<int>& frames,
                                   const std::vector<double>& values);

/// Bars of wall clock time on top of each other.
[[nodiscard]] PagePlot stage_plot(const std::vector<int>& frames,
                                  const std::vector<StageTimes>& stages);

/// Share of surface pixels without history, in percent; NaN: no surface. `cuts` may lie beyond the
/// scale.
[[nodiscard]] PagePlot new_pixels_plot(const std::vector<int>& frames,
                                       const std::vector<double>& percent, std::vector<int> cuts);

}  // namespace eigenlight
