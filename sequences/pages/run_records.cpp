#include "sequences/pages/run_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sequences/files/atomic_file.h"

namespace eigenlight {
namespace {

RunRecord parse_record(std::string_view text, std::string where) {
  RunRecord record{nlohmann::ordered_json::parse(text, nullptr, false), std::move(where)};
  if (!record.json.is_object()) {
    throw std::runtime_error(fmt::format("{}: expected a JSON object", record.where));
  }
  return record;
}

std::vector<RunRecord> read_lines(const std::filesystem::path& path) {
  const std::string text = read_whole_file(path);
  std::vector<RunRecord> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) {
      lines.push_back(parse_record(std::string_view(text).substr(begin, end - begin),
                                   fmt::format("{}: line {}", path.string(), lines.size() + 1)));
    }
    begin = end + 1;
  }
  if (lines.empty()) {
    throw std::runtime_error(fmt::format("{}: no frame is done yet", path.string()));
  }
  return lines;
}

}  // namespace

void RunRecord::refuse(const std::string& pointer) const {
  throw std::runtime_error(
      fmt::format("{}: field '{}' is missing or has a wrong type", where, pointer.substr(1)));
}

RunRecords read_run_records(const std::filesystem::path& dir) {
  const std::filesystem::path run = dir / "run.json";
  return {parse_record(read_whole_file(run), run.string()), read_lines(dir / "frames.jsonl")};
}

}  // namespace eigenlight
