#include "sequences/runs/run_totals.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace eigenlight {

using Json = nlohmann::ordered_json;

void RunTotals::add(const FrameReport& report, const FrameOutput& output) {
  ++frames;
  rays += report.rays;
  non_finite += report.non_finite_pixels + report.non_finite_samples + output.picture.non_finite;
  for (std::size_t s = 0; s < time.size(); ++s) time[s] += report.time[s];
  direct += output.direct;
  antialias += output.antialias;
  write += output.write;
}

double RunTotals::render_ms() const {
  return time[static_cast<std::size_t>(Stage::kSource)].wall_ms +
         time[static_cast<std::size_t>(Stage::kResample)].wall_ms;
}

double RunTotals::mega_rays_per_second() const {
  const double ms = render_ms();
  return ms > 0.0 ? static_cast<double>(rays) * 1e-3 / ms : 0.0;
}

std::string RunTotals::to_json(const std::filesystem::path& directory) const {
  const double n = static_cast<double>(std::max<std::size_t>(frames, 1));
  Json mean = Json::object();
  const auto add_mean = [&](std::string_view name, const StageTime& stage) {
    mean[std::string(name)] = {{"wall", stage.wall_ms / n}, {"cpu", stage.cpu_ms / n}};
  };
  for (std::size_t s = 0; s < time.size(); ++s) add_mean(kStageNames[s], time[s]);
  add_mean("direct", direct);
  add_mean("antialias", antialias);
  add_mean("write", write);
  const Json json{
      {"frames", frames}, {"seconds", seconds},       {"mrays_per_second", mega_rays_per_second()},
      {"mean_ms", mean},  {"non_finite", non_finite}, {"directory", directory.string()}};
  return json.dump() + "\n";
}

std::string RunTotals::to_text(const std::filesystem::path& directory) const {
  const double n = static_cast<double>(std::max<std::size_t>(frames, 1));
  StageTime all = direct;
  for (const StageTime& stage : time) all += stage;
  const double render = render_ms(), denoise = all.wall_ms - render;
  const std::string smooth =
      antialias.wall_ms > 0.0 ? fmt::format("antialias {:.1f}, ", antialias.wall_ms / n) : "";
  std::string text = fmt::format(
      "{} frames in {:.1f} s: render {:.1f}, denoise {:.1f}, {}write {:.1f} ms a frame; "
      "{:.2f} Mrays/s; {}\n",
      frames, seconds, render / n, denoise / n, smooth, write.wall_ms / n, mega_rays_per_second(),
      directory.string());
  if (non_finite > 0) {
    text += fmt::format("excluded: {} pixels or samples with NaN or Inf\n", non_finite);
  }
  return text;
}

}  // namespace eigenlight
