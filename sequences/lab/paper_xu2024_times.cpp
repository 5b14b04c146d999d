// Fig. 12 and Table 2 of Xu 2024: times.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>

#include "sequences/lab/paper_scene.h"
#include "sequences/lab/paper_xu2024.h"
#include "spatial/rivals/atrous_filter.h"
#include "spatial/rivals/cross_bilateral.h"
#include "spatial/rivals/guided_spatial.h"
#include "spatial/rivals/pyramid_filter.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Timed pictures are 5 / 3 as wide and high as the run's: 640x360 by default.
constexpr int kScale = 5, kOver = 3;
constexpr int kRadius = 16;
// Filters take turns, so that other work of the machine affects all alike.
constexpr int kTurns = 9;

struct Timed {
  std::unique_ptr<SpatialFilter> filter;
  double ms = std::numeric_limits<double>::infinity();  // least CPU time of all turns
};

void time_filters(const Frame& frame, int turns, std::span<Timed> filters) {
  Plane<float> weight(frame.extent());
  weight.fill(1.0f);
  Planes<3> out = make_planes<3>(frame.extent());
  for (Timed& timed : filters)
    timed.filter->process({frame, frame.lights[0].radiance, weight}, out);
  for (int turn = 0; turn < turns; ++turn) {
    for (Timed& timed : filters) {
      StageClock clock;
      timed.filter->process({frame, frame.lights[0].radiance, weight}, out);
      timed.ms = std::min(timed.ms, clock.lap().cpu_ms);
    }
  }
}

void claim_times(const std::vector<PlotPoint>& pyramid, const std::vector<TableRow>& rows,
                 PaperReport& report) {
  const auto ms = [&](std::size_t row) { return std::get<double>(rows[row].cells[1]); };
  const auto verdict = [](bool held) { return held ? Verdict::kHeld : Verdict::kNot; };
  const auto [least, most] =
      std::minmax_element(pyramid.begin() + 1, pyramid.end(),
                          [](const PlotPoint& a, const PlotPoint& b) { return a.y < b.y; });
  const double flat = most->y / least->y, first = most->y / pyramid.front().y;
  report.claims.push_back({"Fig. 12", "time does not depend on the radius from 1 to 64",
                           "constant (plot only)",
                           fmt::format("{:.2f} times from 2 to 64, {:.2f} from 1", flat, first),
                           first <= 1.25  ? Verdict::kHeld
                           : flat <= 1.25 ? Verdict::kInPart
                                          : Verdict::kNot});
  report.claims.push_back({"Table 2", "faster than a-trous wavelets", "0.703 / 0.373 = 1.9",
                           fmt::format("{:.1f} times", ms(1) / ms(0)), verdict(ms(1) > ms(0))});
  report.claims.push_back({"Table 2", "brute force takes many times as long",
                           "47.558 / 0.373 = 127", fmt::format("{:.0f} times", ms(3) / ms(0)),
                           ms(3) >= 127.0 * ms(0)  ? Verdict::kHeld
                           : ms(3) >= 10.0 * ms(0) ? Verdict::kInPart
                                                   : Verdict::kNot});
}

}  // namespace

void xu_times(const PaperRun& run, PaperReport& report) {
  const Extent extent{run.extent.width * kScale / kOver, run.extent.height * kScale / kOver};
  run.step(fmt::format("Fig. 12 and Table 2, {}x{}", extent.width, extent.height));
  const PaperScene scene("atrium", Perturbation::kNone, extent, PaperScene::View::kFlight);
  const Frame frame = std::move(scene.render(1, {run.frames.back()}).front());
  std::vector<Timed> filters;
  filters.push_back({std::make_unique<AtrousFilter>(extent, AtrousFilterOptions{})});
  filters.push_back({std::make_unique<GuidedSpatial>(extent, guided_alone())});
  PlotSeries radii{"pyramid", {}};
  for (int radius = 1; radius <= 64; radius *= 2) {
    const GlobalIlluminationEdge edge{.blur_radius = static_cast<float>(radius)};
    filters.push_back({std::make_unique<PyramidFilter>(extent, edge)});
    radii.points.push_back({static_cast<double>(radius), 0.0});
  }
  std::array<Timed, 1> brute{
      {{std::make_unique<CrossBilateral>(extent, CrossBilateralOptions{.radius = kRadius})}}};
  time_filters(frame, kTurns, filters);
  time_filters(frame, 1, brute);
  for (std::size_t i = 0; i < radii.points.size(); ++i) radii.points[i].y = filters[2 + i].ms;
  PageTable table{
      fmt::format("ms per frame, {}x{}, radius {}", extent.width, extent.height, kRadius),
      "The paper: GPU time at 2560x1440, its denoiser. Here: CPU time of all threads. "
      "Brute force is our method cross-bilateral, in vectors.",
      "filter",
      {{"the paper"}, {"here", TableColumn::Best::kLowest}},
      {}};
  table.rows.push_back({"pyramid", {0.373, radii.points[4].y}});
  table.rows.push_back({"a-trous, 4 passes", {0.703, filters[0].ms}});
  table.rows.push_back({"guided, 4 guides", {std::monostate(), filters[1].ms}});
  table.rows.push_back({"brute force", {47.558, brute[0].ms}});
  claim_times(radii.points, table.rows, report);
  PagePlot plot{"Time by radius",
                "CPU time of all threads",
                {"radius, pixels", true},
                {"ms per frame"},
                {std::move(radii)}};
  report.sections.push_back(
      {"Fig. 12 and Table 2: time", "", {std::move(plot)}, {std::move(table)}, {}});
}

}  // namespace eigenlight
