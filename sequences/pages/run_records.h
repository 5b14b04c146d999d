// What `eigenlight render` wrote about a run: run.json and frames.jsonl.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace eigenlight {

/// A JSON object, and where it comes from.
struct RunRecord {
  nlohmann::ordered_json json;
  std::string where;  ///< for messages: the file, and its line if it has several objects

  /// The value at a JSON pointer such as `/stages/source/wall_ms`. Throws std::runtime_error naming
  /// the place and the field if it is missing or has another type.
  template <typename T>
  [[nodiscard]] T get(const std::string& pointer) const {
    try {
      return json.at(nlohmann::ordered_json::json_pointer(pointer)).get<T>();
    } catch (const nlohmann::json::exception&) {
      refuse(pointer);
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& pointer) const;
};

struct RunRecords {
  RunRecord run;
  std::vector<RunRecord> frames;  ///< one or more

  /// The same field of all frames. Throws as RunRecord::get() does.
  template <typename T>
  [[nodiscard]] std::vector<T> column(const std::string& pointer) const {
    std::vector<T> values;
    for (const RunRecord& frame : frames) values.push_back(frame.get<T>(pointer));
    return values;
  }
};

/// Throws std::runtime_error naming the file, and the line of frames.jsonl, that is missing or is
/// not a JSON object; also if frames.jsonl has no line.
[[nodiscard]] RunRecords read_run_records(const std::filesystem::path& dir);

}  // namespace eigenlight
