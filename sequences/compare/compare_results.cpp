#include "sequences/compare/compare_results.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sequences/files/frame_range.h"
#include "sequences/files/machine.h"
#include "sequences/files/version.h"
#include "sequences/metrics/equal_time.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json contenders_json(const ComparePlan& plan) {
  Json list = Json::array();
  for (const Contender& contender : plan.contenders) {
    Json one = {{"label", contender.label}};
    if (!contender.method.empty()) one["method"] = contender.method;
    if (!contender.without.empty()) one["without"] = contender.without;
    if (contender.antialias) one["antialias"] = format_antialias(*contender.antialias);
    if (contender.external) {
      one["command"] = contender.external->command;
      one["time"] = contender.external->time_pattern.empty() ? "CPU time of the program"
                                                             : contender.external->time_pattern;
    }
    list.push_back(std::move(one));
  }
  return list;
}

Json recorded_json(const ComparePlan& plan) {
  const RecordedShot& shot = *plan.recorded;
  return {{"contenders", contenders_json(plan)},
          {"ours", plan.ours().label},
          {"inputs", shot.denoise.files.inputs},
          {"references", {shot.reference, shot.reference_b}},
          {"layer", shot.layer},
          {"frames", format_frame_range(plan.measured)},
          {"denoised_frames", format_frame_range(plan.frames)},
          {"width", plan.extent.width},
          {"height", plan.extent.height}};
}

Json settings_json(const ComparePlan& plan) {
  if (plan.recorded) return recorded_json(plan);
  return {{"contenders", contenders_json(plan)},
          {"ours", plan.ours().label},
          {"spp", plan.spp},
          {"frames", format_frame_range(plan.measured)},
          {"rendered_frames", format_frame_range(plan.frames)},
          {"width", plan.extent.width},
          {"height", plan.extent.height},
          {"bases", plan.bases},
          {"bounces", plan.bounces},
          {"seed", plan.seed},
          {"environment", plan.environment},
          {"reference_spp_each", plan.reference_spp},
          {"memory", kMemoryNote}};
}

Json equal_time_json(const EqualTime& equal) {
  Json json = {{"ms", equal.ms}, {"relmse", Json::object()}};
  for (const auto& [label, error] : equal.relmse) {
    if (error) json["relmse"][label] = *error;
  }
  return json;
}

std::string csv_number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.9g}", *value) : "";
}

std::string short_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : "-";
}

std::string csv_line(const CaseResults& results, const Cell& cell) {
  const SetFigures mean = cell.mean();
  const auto of = [&](PixelSet set, Metric metric) {
    return csv_number(mean[static_cast<std::size_t>(set)][metric]);
  };
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{}\n",
                     results.scene.name, cell.contender, cell.spp,
                     of(PixelSet::kSurface, Metric::kRelmse), csv_number(mean[0].energy()),
                     of(PixelSet::kSurface, Metric::kTemporalError),
                     of(PixelSet::kSurface, Metric::kPsnr), of(PixelSet::kSurface, Metric::kSsim),
                     of(PixelSet::kYoung, Metric::kRelmse), of(PixelSet::kOld, Metric::kRelmse),
                     cell.render_ms + cell.files_ms, cell.denoise_ms, cell.total_ms(),
                     cell.memory_mb, cell.extra_spp, cell.bad_pixels);
}

// Columns of the table for terminals behind the errors.
std::string cost_head(const ComparePlan& plan, const EqualTime& equal) {
  if (plan.recorded) return fmt::format("{:>11}{:>11}", "files ms", "denoise ms");
  return fmt::format("{:>11}{:>11}{:>9}{:>15}", "render ms",
                     plan.is_antialiasing() ? "aa ms" : "denoise ms", "MB",
                     fmt::format("at {:.4g} ms", equal.ms));
}

std::string cost_line(const ComparePlan& plan, const EqualTime& equal, const Cell& cell) {
  const std::string times =
      fmt::format("{:>11.4g}{:>11.4g}", plan.recorded ? cell.files_ms : cell.render_ms,
                  cell.antialias ? cell.antialias->ms : cell.denoise_ms);
  if (plan.recorded) return times;
  return times + fmt::format("{:>9.4g}{:>15}", cell.memory_mb,
                             short_number(equal.relmse.at(cell.contender)));
}

std::string table_of(const ComparePlan& plan, const CaseResults& results) {
  const EqualTime equal = equal_time(plan, results);
  std::string text = fmt::format("{}, {}frames {}\n", results.scene.name, plan.shown_text(", "),
                                 format_frame_range(plan.measured));
  text += fmt::format("{:<32}{:>11}{:>9}{:>11}{}\n", "", "relmse", "energy", "temporal",
                      cost_head(plan, equal));
  for (const Contender& contender : plan.contenders) {
    const Cell* cell = results.find(contender.label, plan.shown_spp());
    if (!cell) continue;
    const SetFigures mean = cell->mean();
    text +=
        fmt::format("{:<32}{:>11}{:>9}{:>11}{}\n", contender.label,
                    short_number(mean[0][Metric::kRelmse]), short_number(mean[0].energy()),
                    short_number(mean[0][Metric::kTemporalError]), cost_line(plan, equal, *cell));
  }
  return text;
}

}  // namespace

const Cell* CaseResults::find(const std::string& contender, int spp) const {
  for (const Cell& cell : cells) {
    if (cell.contender == contender && cell.spp == spp) return &cell;
  }
  return nullptr;
}

std::vector<const Cell*> CaseResults::curve(const std::string& contender) const {
  std::vector<const Cell*> found;
  for (const Cell& cell : cells) {
    if (cell.contender == contender) found.push_back(&cell);
  }
  return found;
}

EqualTime equal_time(const ComparePlan& plan, const CaseResults& results) {
  EqualTime equal;
  const Cell* ours = results.find(plan.ours().label, plan.spp.front());
  equal.ms = plan.equal_time.value_or(ours ? ours->total_ms() : 0.0);
  for (const Contender& contender : plan.contenders) {
    std::vector<CurvePoint> points;
    for (const Cell* cell : results.curve(contender.label)) {
      const auto relmse = cell->mean()[0][Metric::kRelmse];
      if (relmse) points.push_back({cell->total_ms(), *relmse});
    }
    equal.relmse[contender.label] = error_at_time(std::move(points), equal.ms);
  }
  return equal;
}

Json to_json(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  Json json = {{"software", program_version()},
               {"machine", to_json(this_machine())},
               {"settings", settings_json(plan)},
               {"scenes", Json::array()}};
  for (const CaseResults& one : results) {
    Json cells = Json::array();
    for (const Cell& cell : one.cells) cells.push_back(to_json(cell));
    Json scene = {{"name", one.scene.name}, {"scene", one.scene.scene}};
    if (!plan.recorded) {
      scene["perturb"] = one.scene.perturb;
      scene["scene_hash"] = fmt::format("{:016x}", one.scene_hash);
      scene["references"] = one.references;
      scene["equal_time"] = equal_time_json(equal_time(plan, one));
    }
    scene["cells"] = std::move(cells);
    json["scenes"].push_back(std::move(scene));
  }
  return json;
}

std::string to_csv(const std::vector<CaseResults>& results) {
  std::string text =
      "scene,contender,spp,relmse,energy,temporal_error,psnr,ssim,relmse_young,relmse_old,render_"
      "cpu_ms,"
      "denoise_cpu_ms,total_cpu_ms,memory_mb,extra_spp,bad_pixels\n";
  for (const CaseResults& one : results) {
    for (const Cell& cell : one.cells) text += csv_line(one, cell);
  }
  return text;
}

std::string to_table(const ComparePlan& plan, const std::vector<CaseResults>& results) {
  std::string text;
  for (const CaseResults& one : results) {
    if (!text.empty()) text += '\n';
    text += table_of(plan, one);
  }
  return text;
}

}  // namespace eigenlight
