#include "sequences/denoise/denoise_record.h"

#include <fmt/format.h>

#include <map>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// Lines that are whole.
std::vector<Json> whole_lines(const fs::path& path) {
  std::vector<Json> lines;
  std::error_code error;
  if (!fs::exists(path, error)) return lines;
  const std::string text = read_whole_file(path);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;
    Json line = Json::parse(std::string_view(text).substr(begin, end - begin), nullptr, false);
    if (line.is_object() && line.value("frame", Json()).is_number_integer()) {
      lines.push_back(std::move(line));
    }
    begin = end + 1;
  }
  return lines;
}

Json to_json(const DenoiseRecord& record) {
  // An object of nlohmann::json is sorted: the order of stages is that of the list.
  Json stages = Json::array();
  stages.push_back({{"name", "read"}, {"ms", record.read_ms}});
  for (std::size_t s = 0; s < kStageNames.size(); ++s) {
    const double ms = record.report.time[s].wall_ms;
    if (static_cast<Stage>(s) == Stage::kSource) continue;  // frames are read before
    stages.push_back({{"name", kStageNames[s]}, {"ms", ms}});
  }
  stages.push_back({{"name", "compose"}, {"ms", record.compose_ms}});
  stages.push_back({{"name", "write"}, {"ms", record.write_ms}});
  return {{"frame", record.report.frame},
          {"cut", record.report.cut},
          {"stages", std::move(stages)},
          {"new_pixels", record.report.new_pixels},
          {"surface_pixels", record.report.surface_pixels},
          {"non_finite_pixels", record.report.non_finite_pixels},
          {"clamped", record.clamped}};
}

}  // namespace

void add_report(const FrameReport& view, DenoiseRecord& record) {
  FrameReport& sum = record.report;
  sum.frame = view.frame;
  sum.cut |= view.cut;
  for (std::size_t s = 0; s < sum.time.size(); ++s) sum.time[s] += view.time[s];
  for (const FrameCounter& counter : kFrameCounters) sum.*counter.value += view.*counter.value;
}

DenoiseLog::DenoiseLog(fs::path path, bool keeps) : path_(std::move(path)) {
  std::string kept;
  if (keeps) {
    for (const Json& line : whole_lines(path_)) kept += line.dump() + '\n';
  }
  write_file_atomically(path_, kept);
  file_.open(path_, std::ios::app | std::ios::binary);
}

void DenoiseLog::append(const DenoiseRecord& record) {
  file_ << to_json(record).dump() << '\n' << std::flush;
  if (!file_) throw std::runtime_error(fmt::format("{}: cannot write", path_.string()));
}

std::vector<Json> DenoiseLog::read(const fs::path& path, const std::vector<int>& frames) {
  std::map<int, Json> by_frame;
  for (const Json& line : whole_lines(path)) by_frame[line["frame"].get<int>()] = line;
  std::vector<Json> found;
  for (const int frame : frames) {
    const auto line = by_frame.find(frame);
    if (line != by_frame.end()) found.push_back(line->second);
  }
  return found;
}

}  // namespace eigenlight
