#include "sequences/compare/compare_markdown.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/live_source.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/markdown.h"

namespace eigenlight {
namespace {

using Row = std::vector<std::string>;

std::optional<double> ratio(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b && *b > 0.0 ? std::optional(*a / *b) : std::nullopt;
}

std::string number(const std::optional<double>& value, std::string_view form = "{:.3g}") {
  return value && std::isfinite(*value) ? fmt::format(fmt::runtime(form), *value) : "-";
}

std::string code(const std::string& word) { return fmt::format("`{}`", word); }

Figures surface(const Cell& cell) {
  return cell.mean()[static_cast<std::size_t>(PixelSet::kSurface)];
}

std::string intro_of_recorded(const ComparePlan& plan) {
  return fmt::format(
      "{}x{}, frames {} of {}, {}. Measured: {}, all pixels. Times are CPU milliseconds a frame: "
      "files are read, converted and written; denoising is all the rest, of programs what they "
      "take or print. ",
      plan.extent.width, plan.extent.height, format_frame_range(plan.measured),
      format_frame_range(plan.frames), plan.reference_text(), plan.measured_light());
}

std::string intro_of_scenes(const ComparePlan& plan) {
  std::string text = fmt::format("{}x{}, frames {} after {} of history, {}. ", plan.extent.width,
                                 plan.extent.height, format_frame_range(plan.measured),
                                 plan.frames.size() - plan.measured.size(), plan.reference_text());
  if (plan.is_antialiasing()) {
    return text +
           fmt::format(
               "Composed pictures of {} samples, not denoised, against {} with the samples of a "
               "reference spread over its places; the noise of two such pictures drops out too, so "
               "that aliasing is left. Times are CPU milliseconds of a frame of {} samples, "
               "denoised by the default method. ",
               plan.spp.front(), format_antialias(kAntialiasReference), RenderOptions{}.spp);
  }
  return text + "Albedo times indirect light, pixels with a surface; times are CPU milliseconds. ";
}

std::string intro(const ComparePlan& plan) {
  std::string text = plan.recorded ? intro_of_recorded(plan) : intro_of_scenes(plan);
  text +=
      "relMSE = mean((x - r)^2 / (r^2 + 0.01)), temporal error = mean((e_t - e_(t-1))^2), e = x "
      "- r; energy = mean(x) / mean(r). ";
  if (plan.baseline()) {
    text += fmt::format("`/ {0}`: as a multiple of `{0}`. ", plan.baseline()->label);
  }
  return text + "-: not measured.";
}

Row cost_head(const ComparePlan& plan) {
  if (plan.recorded) return {"files ms", "denoise ms"};
  if (!plan.is_antialiasing()) return {"extra spp", "render ms", "denoise ms"};
  const std::string name = format_antialias(kAntialiasReference);
  return {"antialias ms", "rest of the frame ms", name + " / antialias", name + " / frame",
          "unmatched"};
}

// Of recorded frames: what is copied takes no time, and files are in the time of programs.
std::string time_cell(double ms) { return ms > 0.0 ? number(ms, "{:.4g}") : "-"; }

Row cost_cells(const ComparePlan& plan, const Cell& cell) {
  if (plan.recorded) return {time_cell(cell.files_ms), time_cell(cell.denoise_ms)};
  if (!cell.antialias) {
    return {number(cell.extra_spp), number(cell.render_ms, "{:.4g}"), number(cell.denoise_ms)};
  }
  const AntialiasCost& cost = *cell.antialias;
  return {number(cost.ms, "{:.0f}"), number(cell.render_ms + cell.denoise_ms, "{:.0f}"),
          number(ratio(cost.reference_ms, cost.ms), "{:.1f}"),
          number(ratio(cost.reference_ms, cell.total_ms()), "{:.1f}"),
          number(cost.unmatched, "{:.4f}")};
}

void append(Row cells, Row& row) {
  for (std::string& cell : cells) row.push_back(std::move(cell));
}

// A figure, and its multiple of the baseline's if there is one.
Row figure_cells(const Figures& figures, const std::optional<Figures>& base, Metric metric) {
  Row cells{number(figures[metric])};
  if (base) cells.push_back(number(ratio(figures[metric], (*base)[metric]), "{:.4f}"));
  return cells;
}

Row cell_row(const ComparePlan& plan, const CaseResults& scene, const Cell& cell) {
  const Figures figures = surface(cell);
  std::optional<Figures> base;
  if (plan.baseline()) base = surface(*scene.find(plan.baseline()->label, cell.spp));
  Row row{scene.scene.name};
  if (!plan.recorded) row.push_back(fmt::format("{}", cell.spp));
  row.push_back(code(cell.contender));
  append(figure_cells(figures, base, Metric::kRelmse), row);
  row.push_back(number(figures.energy(), "{:.4f}"));
  append(figure_cells(figures, base, Metric::kTemporalError), row);
  row.push_back(number(figures[Metric::kMse]));
  append(cost_cells(plan, cell), row);
  return row;
}

std::string all_cells(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  const Row per = plan.baseline() ? Row{fmt::format("/ {}", plan.baseline()->label)} : Row();
  Row head{plan.recorded ? "shot" : "scene"};
  if (!plan.recorded) head.push_back("spp");
  append({plan.is_antialiasing() ? "antialiasing" : "method", "relMSE"}, head);
  append(per, head);
  append({"energy", "temporal error"}, head);
  append(per, head);
  head.push_back("MSE");
  append(cost_head(plan), head);
  std::vector<Row> rows;
  for (const CaseResults& scene : results) {
    for (const Cell& cell : scene.cells) rows.push_back(cell_row(plan, scene, cell));
  }
  return markdown_table(head, rows, plan.recorded ? 2 : 3);
}

std::string energies(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  if (results.size() < 2) return "";
  Row head{fmt::format("energy, {}", plan.shown_text())};
  for (const CaseResults& scene : results) head.push_back(scene.scene.name);
  std::vector<Row> rows;
  for (const Contender& contender : plan.contenders) {
    Row row{code(contender.label)};
    for (const CaseResults& scene : results) {
      const Cell* cell = scene.find(contender.label, plan.shown_spp());
      row.push_back(cell ? number(surface(*cell).energy(), "{:.4f}") : "-");
    }
    rows.push_back(std::move(row));
  }
  return fmt::format("\n{}", markdown_table(head, rows));
}

std::string equal_times(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  if (plan.spp.size() < 2) return "";
  Row head{"relMSE at", "ms"};
  for (const Contender& contender : plan.contenders) head.push_back(code(contender.label));
  std::vector<Row> rows;
  for (const CaseResults& scene : results) {
    const EqualTime equal = equal_time(plan, scene);
    std::optional<double> best;
    for (const auto& [label, error] : equal.relmse) {
      if (error && (!best || *error < *best)) best = error;
    }
    Row row{scene.scene.name, number(equal.ms, "{:.0f}")};
    for (const Contender& contender : plan.contenders) {
      const std::optional<double>& error = equal.relmse.at(contender.label);
      row.push_back(error && error == best ? fmt::format("**{:.3g}**", *error) : number(error));
    }
    rows.push_back(std::move(row));
  }
  return fmt::format(
      "\nrelMSE at the same total CPU time of a frame, read off the measured curves; -: a curve "
      "does "
      "not reach that time.\n\n{}",
      markdown_table(head, rows));
}

// `0.0171 (1.03)`: a figure and its multiple of the whole method's.
std::string beside_whole(const std::optional<double>& value, const std::optional<double>& whole,
                         std::string_view form = "{:.3g}") {
  return fmt::format("{} ({})", number(value, form), number(ratio(value, whole), "{:.2f}"));
}

Row part_row(const std::string& name, const Cell& cell, const Cell& whole) {
  const Figures f = surface(cell), w = surface(whole);
  return {name,
          beside_whole(f[Metric::kRelmse], w[Metric::kRelmse]),
          number(f.energy(), "{:.4f}"),
          beside_whole(f[Metric::kTemporalError], w[Metric::kTemporalError]),
          beside_whole(cell.denoise_ms, whole.denoise_ms, "{:.1f}"),
          beside_whole(cell.total_ms(), whole.total_ms(), "{:.0f}")};
}

std::string parts(const ComparePlan& plan, const CaseResults& scene) {
  std::vector<Row> rows;
  for (const Contender& contender : plan.contenders) {
    if (contender.without.empty()) continue;
    const Cell* whole = scene.find(contender.method, plan.shown_spp());
    const Cell* cell = scene.find(contender.label, plan.shown_spp());
    if (!whole || !cell) continue;
    if (rows.empty()) rows.push_back(part_row("all parts", *whole, *whole));
    rows.push_back(part_row(fmt::format("without `{}`", contender.without), *cell, *whole));
  }
  if (rows.empty()) return "";
  return fmt::format(
             "\nWhat each part is worth, {}, {}; in parentheses multiples of the whole.\n\n",
             scene.scene.name, plan.shown_text()) +
         markdown_table({"", "relMSE", "energy", "temporal error", "denoise ms", "total ms"}, rows);
}

}  // namespace

std::string to_markdown(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  std::string text = intro(plan) + "\n\n" + all_cells(plan, results) + energies(plan, results) +
                     equal_times(plan, results);
  for (const CaseResults& scene : results) text += parts(plan, scene);
  return text;
}

}  // namespace eigenlight
