#include "sequences/compare/compare_page.h"

#include <fmt/format.h>

#include <functional>
#include <utility>

#include "frame/check.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/machine.h"
#include "sequences/files/version.h"
#include "sequences/metrics/equal_time.h"

namespace eigenlight {
namespace {

TableCell cell_of(const std::optional<double>& value) {
  return value ? TableCell(*value) : TableCell();
}

std::optional<double> figure(const Cell& cell, PixelSet set, Metric metric) {
  return cell.mean()[static_cast<std::size_t>(set)][metric];
}

PagePlot error_against_time(const ComparePlan& plan, const CaseResults& results) {
  PagePlot plot{"Error against time",
                "A ring marks a point if no other point is both faster and better.",
                {plan.recorded ? "CPU time of files and denoising, ms a frame"
                               : "CPU time of rendering and denoising, ms a frame",
                 true},
                {"relMSE", true},
                {}};
  std::vector<CurvePoint> all;
  for (const Contender& contender : plan.contenders) {
    PlotSeries series{contender.label, {}};
    for (const Cell* cell : results.curve(contender.label)) {
      const auto relmse = figure(*cell, PixelSet::kSurface, Metric::kRelmse);
      // The axes are logarithmic: other points are not drawn, so they cannot be on the front.
      if (!relmse || *relmse <= 0.0) continue;
      all.push_back({cell->total_ms(), *relmse});
      series.points.push_back({cell->total_ms(), *relmse,
                               plan.recorded ? contender.label : fmt::format("{} spp", cell->spp)});
    }
    plot.series.push_back(std::move(series));
  }
  const std::vector<bool> front = pareto_front(all);
  std::size_t i = 0;
  for (PlotSeries& series : plot.series) {
    for (PlotPoint& point : series.points) point.is_on_front = front[i++];
  }
  return plot;
}

PagePlot over_frames(const ComparePlan& plan, const CaseResults& results, Metric metric) {
  const bool is_relmse = metric == Metric::kRelmse;
  PagePlot plot{is_relmse ? "Error over the frames" : "Temporal error over the frames",
                plan.shown_text(),
                {"frame"},
                {is_relmse ? "relMSE" : "mean squared change of error", true},
                {}};
  plot.frames = plan.measured;
  for (const Contender& contender : plan.contenders) {
    PlotSeries series{contender.label, {}};
    const Cell* cell = results.find(contender.label, plan.shown_spp());
    for (const FrameFigures& frame : cell->frames) {
      const auto value = frame[PixelSet::kSurface][metric];
      if (value) series.points.push_back({static_cast<double>(frame.frame), *value});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

// A column of the table of figures.
struct FiguresColumn {
  TableColumn head;
  std::function<TableCell(const Cell&)> value;
};

FiguresColumn error_column(const char* title, Metric metric, TableColumn::Best best,
                           PixelSet set = PixelSet::kSurface) {
  return {{title, best}, [=](const Cell& cell) { return cell_of(figure(cell, set, metric)); }};
}

std::vector<FiguresColumn> columns_of(const ComparePlan& plan, const EqualTime& equal) {
  using Best = TableColumn::Best;
  std::vector<FiguresColumn> columns{
      error_column("relMSE", Metric::kRelmse, Best::kLowest),
      {{"energy"}, [](const Cell& cell) { return cell_of(cell.mean()[0].energy()); }},
      error_column("temporal error", Metric::kTemporalError, Best::kLowest),
      error_column("PSNR, dB", Metric::kPsnr, Best::kHighest),
      error_column("SSIM", Metric::kSsim, Best::kHighest)};
  const auto add = [&](std::string title, Best best, auto value) {
    columns.push_back({{std::move(title), best}, std::move(value)});
  };
  const auto render = [](const Cell& cell) { return TableCell(cell.render_ms); };
  const auto method = [](const Cell& cell) {
    return TableCell(cell.antialias ? cell.antialias->ms : cell.denoise_ms);
  };
  if (plan.recorded) {
    // What is copied takes no time, and files are in the time of programs.
    const auto cell_of_time = [](double ms) { return ms > 0.0 ? TableCell(ms) : TableCell(); };
    add("files, ms", Best::kNone, [=](const Cell& cell) { return cell_of_time(cell.files_ms); });
    add("denoise, ms", Best::kLowest,
        [=](const Cell& cell) { return cell_of_time(cell.denoise_ms); });
    return columns;
  }
  columns.push_back(
      error_column("relMSE, young", Metric::kRelmse, Best::kLowest, PixelSet::kYoung));
  columns.push_back(error_column("relMSE, old", Metric::kRelmse, Best::kLowest, PixelSet::kOld));
  add("render, ms", Best::kLowest, render);
  add(plan.is_antialiasing() ? "antialias, ms" : "denoise, ms", Best::kLowest, method);
  add("extra spp", Best::kNone, [](const Cell& cell) { return TableCell(cell.extra_spp); });
  add("memory, MB", Best::kNone, [](const Cell& cell) { return TableCell(cell.memory_mb); });
  add(fmt::format("relMSE at {:.4g} ms", equal.ms), Best::kLowest,
      [equal](const Cell& cell) { return cell_of(equal.relmse.at(cell.contender)); });
  return columns;
}

std::string figures_note(const ComparePlan& plan) {
  const std::string note =
      "The best value of a column is bold. Energy is the mean of the output over the mean of the "
      "reference. ";
  if (plan.recorded) {
    return note +
           "Times are CPU times a frame. Files are read, converted and written; denoising is all "
           "the rest of the run, of programs what they take or print.";
  }
  return note + fmt::format(
                    "Young pixels have fewer than {} frames of history. Times are CPU times a "
                    "frame; the time of rendering includes the extra samples that a method asks "
                    "for. The error at equal time is interpolated between measured points and "
                    "never extrapolated. Memory: {}.",
                    kYoungAge, kMemoryNote);
}

PageTable figures_table(const ComparePlan& plan, const CaseResults& results) {
  const std::vector<FiguresColumn> columns = columns_of(plan, equal_time(plan, results));
  PageTable table{(plan.recorded ? "Means over frames " : plan.shown_text(", means over frames ")) +
                      format_frame_range(plan.measured),
                  figures_note(plan),
                  "method",
                  {},
                  {}};
  for (const FiguresColumn& column : columns) table.columns.push_back(column.head);
  for (const Contender& contender : plan.contenders) {
    const Cell& cell = *results.find(contender.label, plan.shown_spp());
    TableRow row{contender.label, {}};
    for (const FiguresColumn& column : columns) row.cells.push_back(column.value(cell));
    table.rows.push_back(std::move(row));
  }
  return table;
}

TableCell ratio(const TableCell& of, const TableCell& to) {
  const auto* a = std::get_if<double>(&of);
  const auto* b = std::get_if<double>(&to);
  return a && b && *b > 0.0 ? TableCell(*a / *b) : TableCell();
}

// The figures of `cell`, those that have a ratio followed by that to the figure of `whole`.
TableRow ablation_row(const std::string& label, const Cell& cell, const Cell& whole) {
  TableRow row{label, {}};
  const auto add = [&](const TableCell& value, const TableCell& of_whole) {
    row.cells.push_back(value);
    row.cells.push_back(ratio(value, of_whole));
  };
  const auto add_figure = [&](Metric m) {
    add(cell_of(figure(cell, PixelSet::kSurface, m)),
        cell_of(figure(whole, PixelSet::kSurface, m)));
  };
  add_figure(Metric::kRelmse);
  row.cells.push_back(cell_of(cell.mean()[0].energy()));
  add_figure(Metric::kTemporalError);
  add(cell.render_ms, whole.render_ms);
  add(cell.denoise_ms, whole.denoise_ms);
  return row;
}

// One row for a method with all its parts, and one without each; nothing if no contender lacks one.
void add_ablation(const ComparePlan& plan, const CaseResults& results, PageSection& section) {
  PageTable table{
      fmt::format("What each part is worth, {}", plan.shown_text()),
      "A factor is the ratio to the method with all its parts. If it is above 1 without "
      "a part, that part lowers the error or saves time.",
      "method",
      {{"relMSE"},
       {"factor"},
       {"energy"},
       {"temporal error"},
       {"factor"},
       {"render, ms"},
       {"factor"},
       {"denoise, ms"},
       {"factor"}},
      {}};
  for (const Contender& contender : plan.contenders) {
    if (contender.without.empty()) continue;
    const Cell& whole = *results.find(contender.method, plan.shown_spp());
    if (table.rows.empty()) table.rows.push_back(ablation_row(contender.method, whole, whole));
    const Cell& cell = *results.find(contender.label, plan.shown_spp());
    table.rows.push_back(ablation_row(contender.label, cell, whole));
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

PageSection setup_section(const ComparePlan& plan) {
  const Machine machine = this_machine();
  PageSection section{"Setup", "", {}, {}, {}};
  std::vector<std::pair<std::string, std::string>> facts{
      {"processor", fmt::format("{}, {} cores", machine.processor, machine.cores)},
      {"software", program_version() + ", " + machine.compiler}};
  if (plan.recorded) {
    const RecordedShot& shot = *plan.recorded;
    facts.emplace_back("files", fmt::format("{}", fmt::join(shot.denoise.files.inputs, " ")));
    facts.emplace_back("references", shot.reference + " " + shot.reference_b);
    facts.emplace_back("frames", format_frame_range(plan.frames));
  } else {
    facts.emplace_back("seed", fmt::format("{}", plan.seed));
    facts.emplace_back("bounces", fmt::format("{}", plan.bounces));
    facts.emplace_back("bases", fmt::format("up to {}", plan.bases));
  }
  section.tables = {facts_table("Machine and settings", facts)};
  return section;
}

}  // namespace

Page compare_page(const ComparePlan& plan, const std::vector<CaseResults>& results,
                  std::vector<PageGallery> galleries) {
  EL_CHECK(galleries.size() == results.size(), "{} galleries for {} scenes", galleries.size(),
           results.size());
  Page page;
  page.title = plan.is_antialiasing() ? "Antialiasing compared: error against run time"
                                      : "Denoisers compared: error against run time";
  page.subtitle = fmt::format(
      "{} × {} pixels, frames {}{}. The error is that of {} against {}.", plan.extent.width,
      plan.extent.height, format_frame_range(plan.measured),
      plan.recorded
          ? ""
          : fmt::format(" after {} frames of history", plan.frames.size() - plan.measured.size()),
      plan.measured_light(), plan.reference_text());
  for (const Contender& contender : plan.contenders) page.names.push_back(contender.label);
  for (std::size_t i = 0; i < results.size(); ++i) {
    PageSection section{results[i].scene.name, results[i].title, {}, {}, {}};
    section.plots = {error_against_time(plan, results[i]),
                     over_frames(plan, results[i], Metric::kRelmse),
                     over_frames(plan, results[i], Metric::kTemporalError)};
    section.tables = {figures_table(plan, results[i])};
    add_ablation(plan, results[i], section);
    section.galleries = {std::move(galleries[i])};
    page.sections.push_back(std::move(section));
  }
  page.sections.push_back(setup_section(plan));
  return page;
}

}  // namespace eigenlight
