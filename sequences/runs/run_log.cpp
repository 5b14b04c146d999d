#include "sequences/runs/run_log.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "sequences/files/atomic_file.h"
#include "sequences/files/frame_range.h"
#include "sequences/files/version.h"
#include "sequences/runs/flythrough.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const StageTime& time) { return {{"wall_ms", time.wall_ms}, {"cpu_ms", time.cpu_ms}}; }

Json parse_object(std::string_view text, std::string_view whose) {
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw std::runtime_error(fmt::format("the description of {} is not a JSON object", whose));
  }
  return json;
}

std::string show(const Json& json, const std::string& key) {
  if (!json.contains(key)) return "not given";
  return json[key].is_string() ? json[key].get<std::string>() : json[key].dump();
}

// The kept lines of an older log. Each is checked to be that of its frame.
std::string kept_lines(const std::filesystem::path& path, const std::vector<int>& frames,
                       std::size_t kept) {
  if (kept == 0) return "";
  const std::string text = read_whole_file(path);
  std::size_t end = 0;
  for (std::size_t line = 0; line < kept; ++line) {
    const std::size_t next = text.find('\n', end);
    const Json json = next == std::string::npos
                          ? Json()
                          : Json::parse(text.substr(end, next - end), nullptr, false);
    if (!json.is_object() || json.value("frame", Json()) != Json(frames[line])) {
      throw std::runtime_error(fmt::format("{}: line {}: expected the line of frame {}",
                                           path.string(), line + 1, frames[line]));
    }
    end = next + 1;
  }
  return text.substr(0, end);
}

}  // namespace

std::string to_json_text(const RunDescription& run) {
  const Json json{{"software", program_version()},
                  {"scene", run.scene},
                  {"title", run.title},
                  {"scene_hash", fmt::format("{:016x}", run.scene_hash)},
                  {"environment", run.environment},
                  {"frames", format_frame_range(run.frames)},
                  {"frame_count", run.frames.size()},
                  {"width", run.extent.width},
                  {"height", run.extent.height},
                  {"spp", run.spp},
                  {"direct_spp", run.direct_spp},
                  {"bounces", run.bounces},
                  {"method", run.method},
                  {"without", run.without},
                  {"bases", run.bases},
                  {"seed", run.seed},
                  {"perturb", run.perturb},
                  {"antialias", run.antialias},
                  {"layers", run.layers},
                  {"exposure", run.exposure},
                  {"frames_per_second", kFramesPerSecond}};
  return json.dump(2) + "\n";
}

std::string first_difference(std::string_view there, std::string_view here) {
  const Json a = parse_object(there, "the other run");
  const Json b = parse_object(here, "this run");
  for (const Json& json : {a, b}) {
    for (const auto& [key, value] : json.items()) {
      if (a.contains(key) && b.contains(key) && a[key] == b[key]) continue;
      return fmt::format("{} is {} there, {} here", key, show(a, key), show(b, key));
    }
  }
  return "";
}

RunLog::RunLog(const std::filesystem::path& directory, const std::vector<int>& frames,
               std::size_t kept)
    : path_(directory / "frames.jsonl") {
  write_file_atomically(path_, kept_lines(path_, frames, kept));
  file_.open(path_, std::ios::app | std::ios::binary);
}

void RunLog::append(const FrameReport& report, int spp, const FrameOutput& output) {
  Json stages = Json::object();
  for (std::size_t s = 0; s < kStageNames.size(); ++s) {
    stages[std::string(kStageNames[s])] = to_json(report.time[s]);
  }
  stages["antialias"] = to_json(output.antialias);
  stages["write"] = to_json(output.write);
  const double surface = static_cast<double>(report.surface_pixels);
  const double new_share =
      report.surface_pixels > 0 ? static_cast<double>(report.new_pixels) / surface : 0.0;
  const Json line{{"frame", report.frame},
                  {"cut", report.cut},
                  {"stages", stages},
                  {"rays", report.rays},
                  {"antialias",
                   {{"rays", output.picture.rays},
                    {"unmatched", output.picture.unmatched},
                    {"non_finite", output.picture.non_finite}}},
                  {"samples", spp * report.surface_pixels + report.extra_samples},
                  {"extra_samples", report.extra_samples},
                  {"surface_pixels", report.surface_pixels},
                  {"new_pixels", report.new_pixels},
                  {"new_share", new_share},
                  {"rank", report.mean_rank},
                  {"skipped",
                   {{"warp", report.skipped_warp},
                    {"surface", report.skipped_surface},
                    {"filter", report.skipped_filter},
                    {"geometry", report.skipped_geometry},
                    {"guided", report.skipped_guided},
                    {"correction", report.skipped_correction}}},
                  {"non_finite_pixels", report.non_finite_pixels},
                  {"non_finite_samples", report.non_finite_samples},
                  {"unguided_pixels", report.unguided_pixels},
                  {"bounded_pixels", report.bounded_pixels}};
  errno = 0;
  file_ << line.dump() << '\n' << std::flush;
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", path_.string(), std::strerror(errno)));
  }
}

void RunTotals::add(const FrameReport& report, const FrameOutput& output) {
  ++frames;
  rays += report.rays;
  non_finite += report.non_finite_pixels + report.non_finite_samples + output.picture.non_finite;
  for (std::size_t s = 0; s < time.size(); ++s) {
    time[s].wall_ms += report.time[s].wall_ms;
    time[s].cpu_ms += report.time[s].cpu_ms;
  }
  antialias.wall_ms += output.antialias.wall_ms;
  antialias.cpu_ms += output.antialias.cpu_ms;
  write.wall_ms += output.write.wall_ms;
  write.cpu_ms += output.write.cpu_ms;
}

double RunTotals::mega_rays_per_second() const {
  const double ms = time[static_cast<std::size_t>(Stage::kSource)].wall_ms +
                    time[static_cast<std::size_t>(Stage::kResample)].wall_ms;
  return ms > 0.0 ? static_cast<double>(rays) * 1e-3 / ms : 0.0;
}

std::string RunTotals::to_json(const std::filesystem::path& directory) const {
  const double n = static_cast<double>(std::max<std::size_t>(frames, 1));
  Json mean = Json::object();
  const auto add_mean = [&](std::string_view name, const StageTime& stage) {
    mean[std::string(name)] = {{"wall", stage.wall_ms / n}, {"cpu", stage.cpu_ms / n}};
  };
  for (std::size_t s = 0; s < time.size(); ++s) add_mean(kStageNames[s], time[s]);
  add_mean("antialias", antialias);
  add_mean("write", write);
  const Json json{
      {"frames", frames}, {"seconds", seconds},       {"mrays_per_second", mega_rays_per_second()},
      {"mean_ms", mean},  {"non_finite", non_finite}, {"directory", directory.string()}};
  return json.dump() + "\n";
}

std::string RunTotals::to_text(const std::filesystem::path& directory) const {
  const double n = static_cast<double>(std::max<std::size_t>(frames, 1));
  double denoise = 0.0;
  for (const StageTime& stage : time) denoise += stage.wall_ms;
  const double render = time[static_cast<std::size_t>(Stage::kSource)].wall_ms +
                        time[static_cast<std::size_t>(Stage::kResample)].wall_ms;
  denoise -= render;
  const std::string smooth =
      antialias.wall_ms > 0.0 ? fmt::format("antialias {:.1f}, ", antialias.wall_ms / n) : "";
  std::string text = fmt::format(
      "{} frames in {:.1f} s: render {:.1f}, denoise {:.1f}, {}write {:.1f} ms a frame; "
      "{:.2f} Mrays/s; {}\n",
      frames, seconds, render / n, denoise / n, smooth, write.wall_ms / n, mega_rays_per_second(),
      directory.string());
  if (non_finite > 0)
    text += fmt::format("excluded: {} pixels or samples with NaN or Inf\n", non_finite);
  return text;
}

}  // namespace eigenlight
