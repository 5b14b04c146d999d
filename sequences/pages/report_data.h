// What the report page shows besides pictures, from run.json and frames.jsonl.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace eigenlight {

struct ReportData {
  std::string title;  ///< plain text
  std::vector<int> frames;
  float exposure = 1.0f;
  float frames_per_second = 24.0f;
  /// For the page's script: subtitle, method, pixels of a frame, summary [[name, value]], frames,
  /// cut, stages [{name, wall_ms, cpu_ms}], new_share, rank, skips [{name, pixels}]; one value a
  /// frame, null where a frame without surface has none. Stages that never took time are left out.
  nlohmann::ordered_json page;
};

/// Throws std::runtime_error naming the file (and line) that is missing, is not JSON, or lacks a
/// field; also if frames.jsonl has no line yet.
[[nodiscard]] ReportData read_report_data(const std::filesystem::path& dir);

}  // namespace eigenlight
