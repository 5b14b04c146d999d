#include "sequences/runs/run_log.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "frame/bad_file.h"
#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const StageTime& time) { return {{"wall_ms", time.wall_ms}, {"cpu_ms", time.cpu_ms}}; }

// The first lines of an older log, each checked to be that of its frame.
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
      throw BadFile(fmt::format("{}: line {}: expected the line of frame {}", path.string(),
                                line + 1, frames[line]));
    }
    end = next + 1;
  }
  return text.substr(0, end);
}

Json stages_of(const FrameReport& report, const FrameOutput& output) {
  Json stages = Json::object();
  for (std::size_t s = 0; s < kStageNames.size(); ++s) {
    stages[std::string(kStageNames[s])] = to_json(report.time[s]);
  }
  stages["direct"] = to_json(output.direct);
  stages["antialias"] = to_json(output.antialias);
  stages["write"] = to_json(output.write);
  return stages;
}

Json skips_of(const FrameReport& report) {
  Json skips = Json::object();
  for (const SkipCounter& counter : kSkipCounters) {
    skips[std::string(counter.name)] = report.*counter.value;
  }
  return skips;
}

double new_share(const FrameReport& report) {
  if (report.surface_pixels == 0) return 0.0;
  return static_cast<double>(report.new_pixels) / static_cast<double>(report.surface_pixels);
}

}  // namespace

RunLog::RunLog(const std::filesystem::path& directory, const std::vector<int>& frames,
               std::size_t kept)
    : path_(directory / "frames.jsonl") {
  write_file_atomically(path_, kept_lines(path_, frames, kept));
  file_.open(path_, std::ios::app | std::ios::binary);
}

void RunLog::append(const FrameReport& report, int spp, const FrameOutput& output) {
  Json line{{"frame", report.frame},
            {"cut", report.cut},
            {"stages", stages_of(report, output)},
            {"antialias",
             {{"rays", output.picture.rays},
              {"unmatched", output.picture.unmatched},
              {"non_finite", output.picture.non_finite}}},
            {"samples", spp * report.surface_pixels + report.extra_samples},
            {"new_share", new_share(report)},
            {"rank", report.mean_rank},
            {"skipped", skips_of(report)}};
  for (const FrameCounter& counter : kFrameCounters) {
    line[std::string(counter.name)] = report.*counter.value;
  }
  errno = 0;
  file_ << line.dump() << '\n' << std::flush;
  if (!file_) {
    throw std::runtime_error(
        fmt::format("{}: cannot write: {}", path_.string(), std::strerror(errno)));
  }
}

}  // namespace eigenlight
