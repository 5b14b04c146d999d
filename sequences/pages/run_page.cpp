#include "sequences/pages/run_page.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numeric>

#include "sequences/files/atomic_file.h"
#include "sequences/pages/run_pictures.h"
#include "sequences/pages/run_records.h"
#include "sequences/pages/stage_times.h"
#include "temporal/frame_report.h"

namespace eigenlight {
namespace {

using Values = std::vector<double>;

double total(const Values& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double mean(const Values& values) { return total(values) / static_cast<double>(values.size()); }

// ---- stage times

// In the order of the log. Stages that never took time are left out.
std::vector<StageTimes> stage_times(const RunRecords& records) {
  std::vector<StageTimes> stages;
  // Named, because items() does not keep a temporary alive.
  const auto first = records.frames.front().get<nlohmann::ordered_json>("/stages");
  for (const auto& [name, times] : first.items()) {
    StageTimes stage{name, records.column<double>("/stages/" + name + "/wall_ms"),
                     records.column<double>("/stages/" + name + "/cpu_ms")};
    if (total(stage.wall_ms) > 0.0 || total(stage.cpu_ms) > 0.0) stages.push_back(std::move(stage));
  }
  return stages;
}

PageBackground background_of(const std::vector<StageTimes>& stages) {
  PageBackground background{"rendering and files", {}};
  for (const StageTimes& stage : stages) {
    for (const char* name : {"source", "resample", "antialias", "write"}) {
      if (stage.name == name) background.names.emplace_back(name);
    }
  }
  return background;
}

// ---- plots over the frames

// A value that exists only where a frame shows a surface, times `factor`.
Values on_surfaces(const RunRecords& records, const char* pointer, double factor) {
  Values values = records.column<double>(pointer);
  const auto surface = records.column<std::int64_t>("/surface_pixels");
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = surface[i] > 0 ? factor * values[i] : std::nan("");
  }
  return values;
}

PagePlot rank_plot(const std::vector<int>& frames, const Values& values) {
  PagePlot plot{"Rank",
                "Mean number of bases in use, over the tiles with a surface.",
                {"frame"},
                {"bases"},
                {series_of("rank", frames, values)}};
  plot.y.starts_at_zero = true;
  plot.frames = frames;
  return plot;
}

PageSection frames_section(const RunRecords& records, const std::vector<int>& frames,
                           const std::vector<StageTimes>& stages) {
  PageSection section{"Over the frames", "Click a plot to see that frame.", {}, {}, {}};
  section.plots.push_back(stage_plot(frames, stages));
  std::vector<int> cuts;
  const auto is_cut = records.column<bool>("/cut");
  for (std::size_t i = 0; i < is_cut.size(); ++i) {
    if (is_cut[i]) cuts.push_back(frames[i]);
  }
  section.plots.push_back(
      new_pixels_plot(frames, on_surfaces(records, "/new_share", 100.0), std::move(cuts)));
  section.plots.push_back(rank_plot(frames, on_surfaces(records, "/rank", 1.0)));
  return section;
}

// ---- tables

// Counters of other versions of the program are shown by their names.
std::string skip_text(const std::string& name) {
  for (const SkipCounter& counter : kSkipCounters) {
    if (counter.name == name) return std::string(counter.text);
  }
  return name;
}

PageTable skip_table(const RunRecords& records, double pixels) {
  PageTable table{
      "Skipped work, mean per frame", "", "step and reason", {{"pixels"}, {"share, %"}}, {}};
  const auto first = records.frames.front().get<nlohmann::ordered_json>("/skipped");
  for (const auto& [key, count] : first.items()) {
    const double skipped = mean(records.column<double>("/skipped/" + key));
    table.rows.push_back({skip_text(key), {std::round(skipped), 100.0 * skipped / pixels}});
  }
  return table;
}

std::string millions(double value) { return fmt::format("{:.3g} million", value / 1e6); }

std::string rays_per_second(const RunRecords& records) {
  const double rays = total(records.column<double>("/rays"));
  const double ms = total(records.column<double>("/stages/source/wall_ms")) +
                    total(records.column<double>("/stages/resample/wall_ms"));
  return ms > 0.0 && rays > 0.0 ? millions(1e3 * rays / ms) : "none traced";
}

PageTable run_table(const RunRecords& records) {
  const RunRecord& run = records.run;
  const auto sum = [&](const char* pointer) { return total(records.column<double>(pointer)); };
  const auto text = [&](const char* pointer) { return run.get<std::string>(pointer); };
  std::vector<std::pair<std::string, std::string>> facts{{"scene", text("/scene")},
                                                         {"perturbation", text("/perturb")},
                                                         {"method", text("/method")},
                                                         {"direct light", text("/direct")},
                                                         {"antialiasing", text("/antialias")}};
  const auto add = [&](const char* name, std::string value) {
    facts.emplace_back(name, std::move(value));
  };
  if (!text("/without").empty()) add("without", text("/without"));
  if (sum("/rank") > 0.0) add("bases", fmt::format("up to {}", run.get<int>("/bases")));
  add("size", fmt::format("{} × {} pixels", run.get<int>("/width"), run.get<int>("/height")));
  add("frames", fmt::format("{} of {} ({})", records.frames.size(), run.get<int>("/frame_count"),
                            text("/frames")));
  add("samples per pixel", fmt::format("{}", run.get<int>("/spp")));
  if (const double surface = sum("/surface_pixels"); surface > 0.0) {
    add("with resampling", fmt::format("{:.2f} on surfaces", sum("/samples") / surface));
  }
  add("rays per second", rays_per_second(records));
  add("rays per frame", millions(mean(records.column<double>("/rays"))));
  add("excluded as NaN or Inf", fmt::format("{:.0f} pixels, {:.0f} samples",
                                            sum("/non_finite_pixels"), sum("/non_finite_samples")));
  add("seed", fmt::format("{}", run.get<std::uint32_t>("/seed")));
  add("software", text("/software"));
  return facts_table("Run", facts);
}

PageSection player_section(const RunRecords& records, const std::filesystem::path& dir,
                           const std::vector<int>& frames) {
  PictureOptions options;
  options.method = records.run.get<std::string>("/method");
  options.exposure = records.run.get<float>("/exposure");
  options.frames_per_second = records.run.get<double>("/frames_per_second");
  PageGallery player = run_pictures(dir, frames, options);
  PageSection section;
  if (player.frames.empty()) {
    section.note = "No pictures: no file of a frame holds color or indirect light.";
  } else {
    section.galleries = {std::move(player)};
  }
  return section;
}

}  // namespace

Page run_page(const std::filesystem::path& dir) {
  const RunRecords records = read_run_records(dir);
  const auto frames = records.column<int>("/frame");
  const std::vector<StageTimes> stages = stage_times(records);
  const auto scene = records.run.get<std::string>("/scene");
  const auto title = records.run.get<std::string>("/title");
  const double pixels = records.run.get<double>("/width") * records.run.get<double>("/height");
  Page page;
  page.title =
      fmt::format("{}: {}", title.empty() ? scene : title, records.run.get<std::string>("/method"));
  page.subtitle = "Eigenlight: temporal denoising of path-traced light";
  for (const StageTimes& stage : stages) page.names.push_back(stage.name);
  page.background = background_of(stages);
  PageSection summary{"Summary", "", {}, {}, {}};
  summary.tables = {run_table(records), stage_table(stages), skip_table(records, pixels)};
  page.sections = {player_section(records, dir, frames), std::move(summary),
                   frames_section(records, frames, stages)};
  return page;
}

void write_run_page(const std::filesystem::path& dir) {
  write_file_atomically(dir / "index.html", to_html(run_page(dir)));
}

}  // namespace eigenlight
