#include "sequences/denoise/denoise_page.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "sequences/denoise/denoise_pictures.h"
#include "sequences/denoise/denoise_record.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/version.h"
#include "sequences/pages/stage_times.h"

namespace eigenlight {
namespace {

using Json = nlohmann::json;
using Lines = std::vector<Json>;

std::vector<int> numbers(const DenoisePlan& plan) {
  std::vector<int> frames;
  for (const FrameFiles& files : plan.frames) frames.push_back(files.frame);
  return frames;
}

// In the order of the log; stages that never took time are left out.
std::vector<StageTimes> stages_of(const Lines& lines) {
  std::vector<StageTimes> stages;
  if (lines.empty()) return stages;
  const Json& first = lines.front().at("stages");
  for (std::size_t s = 0; s < first.size(); ++s) {
    StageTimes stage{first[s].at("name").get<std::string>(), {}, {}};
    double total = 0.0;
    for (const Json& line : lines) {
      stage.wall_ms.push_back(line.at("stages").at(s).at("ms").get<double>());
      total += stage.wall_ms.back();
    }
    if (total > 0.0) stages.push_back(std::move(stage));
  }
  return stages;
}

std::int64_t sum_of(const Lines& lines, const char* name) {
  std::int64_t sum = 0;
  for (const Json& line : lines) sum += line.at(name).get<std::int64_t>();
  return sum;
}

PageTable run_table(const DenoisePlan& plan, const DenoiseTotals& totals, const Lines& lines) {
  const FrameFiles &first = plan.frames.front(), &last = plan.frames.back();
  std::vector<std::pair<std::string, std::string>> facts{
      {"inputs",
       fmt::format("{} to {}", first.inputs.front().string(), last.inputs.front().string())},
      {"outputs",
       fmt::format("{} to {}", first.outputs.front().string(), last.outputs.front().string())},
      {"frames", fmt::format("{} ({})", plan.frames.size(), format_frame_range(numbers(plan)))},
      {"size", fmt::format("{} × {} pixels at ({}, {})", plan.canvas.width, plan.canvas.height,
                           plan.canvas.x, plan.canvas.y)}};
  if (!plan.cuts.empty()) facts.emplace_back("cuts", format_frame_range(plan.cuts));
  if (totals.frames > 0) {
    facts.emplace_back(
        "wall clock",
        fmt::format("{:.1f} s for {} frames, {:.2f} s a frame", totals.seconds, totals.frames,
                    totals.seconds / static_cast<double>(totals.frames)));
  }
  facts.emplace_back("excluded as NaN or Inf", fmt::format("{} pixels of layers of light",
                                                           sum_of(lines, "non_finite_pixels")));
  facts.emplace_back("beyond the range of half",
                     fmt::format("{} values, written as 65504", sum_of(lines, "clamped")));
  facts.emplace_back("software", program_version());
  return facts_table("Run", facts);
}

PageTable layer_table(const LayerPlan& plan) {
  PageTable table{"Layers", "", "layer", {{"role"}, {"use"}, {"part"}, {"type"}, {"why"}}, {}};
  for (const PlanRow& row : plan.rows) {
    table.rows.push_back({row.layer, {row.role, row.use, row.part, row.type, row.why}});
  }
  return table;
}

// `camera: from shot.camera.json` stands in two columns.
PageTable text_table(std::string title, const std::vector<std::string>& lines) {
  std::vector<std::pair<std::string, std::string>> facts;
  for (const std::string& line : lines) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) {
      facts.emplace_back("", line);
    } else {
      facts.emplace_back(line.substr(0, colon), line.substr(colon + 2));
    }
  }
  return facts_table(std::move(title), facts);
}

PageSection frames_section(const DenoisePlan& plan, const std::vector<StageTimes>& stages,
                           const Lines& lines) {
  // New pixels are counted in each layer of light.
  const auto layers = static_cast<double>(plan.layers.views.front().lights.size());
  PageSection section{"Over the frames", "Click a plot to see that frame.", {}, {}, {}};
  std::vector<int> frames, cuts;
  std::vector<double> percent;
  for (const Json& line : lines) {
    frames.push_back(line.at("frame").get<int>());
    if (line.at("cut").get<bool>()) cuts.push_back(frames.back());
    const auto surface = line.at("surface_pixels").get<double>();
    const double fresh = line.at("new_pixels").get<double>() / layers;
    percent.push_back(surface > 0.0 ? 100.0 * fresh / surface : std::nan(""));
  }
  section.plots.push_back(stage_plot(frames, stages));
  section.plots.back().note =
      "Reading, denoising and writing overlap: a frame takes less than the sum.";
  section.plots.push_back(new_pixels_plot(frames, percent, std::move(cuts)));
  return section;
}

PageBackground background_of(const std::vector<StageTimes>& stages) {
  PageBackground background{"files", {}};
  for (const StageTimes& stage : stages) {
    if (stage.name == "read" || stage.name == "write") background.names.push_back(stage.name);
  }
  return background;
}

}  // namespace

std::filesystem::path denoise_page_folder(const DenoisePlan& plan) {
  return plan.frames.front().outputs.front().parent_path() / "page";
}

Page denoise_page(const DenoisePlan& plan, const DenoiseTotals& totals) {
  const Lines lines = DenoiseLog::read(denoise_page_folder(plan) / "frames.jsonl", numbers(plan));
  const std::vector<StageTimes> stages = stages_of(lines);
  Page page;
  page.title =
      fmt::format("{} to {}, denoised", plan.frames.front().inputs.front().filename().string(),
                  plan.frames.back().inputs.front().filename().string());
  page.subtitle = "Eigenlight: denoised frames of another renderer";
  for (const StageTimes& stage : stages) page.names.push_back(stage.name);
  page.background = background_of(stages);
  PageSection player{"", "", {}, {}, {}};
  if (!plan.warnings.empty()) player.tables = {text_table("Warnings", plan.warnings)};
  player.galleries = {denoise_pictures(plan)};
  std::vector<std::string> found = plan.notes;
  found.insert(found.end(), totals.notes.begin(), totals.notes.end());
  PageSection summary{"Summary", "", {}, {}, {}};
  summary.tables = {run_table(plan, totals, lines)};
  if (!stages.empty()) summary.tables.push_back(stage_table(stages));
  PageSection layers{"Layers and what they mean", "", {}, {}, {}};
  layers.tables = {layer_table(plan.layers), text_table("Found on the first frames", found)};
  page.sections = {std::move(player), std::move(summary), std::move(layers)};
  if (!lines.empty()) page.sections.push_back(frames_section(plan, stages, lines));
  return page;
}

void write_denoise_page(const DenoisePlan& plan, const DenoiseTotals& totals) {
  write_file_atomically(denoise_page_folder(plan) / "index.html",
                        to_html(denoise_page(plan, totals)));
}

}  // namespace eigenlight
