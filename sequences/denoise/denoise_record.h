// How each frame of a run went, and the log of it: page/frames.jsonl beside the outputs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "temporal/frame_report.h"

namespace eigenlight {

struct DenoiseRecord {
  FrameReport report;  ///< of all views together; `frame` is the number of the frame
  /// Wall clock milliseconds. Reading, denoising and writing overlap.
  double read_ms = 0.0, compose_ms = 0.0, write_ms = 0.0;
  std::int64_t clamped = 0;  ///< values beyond the range of half
};

/// Adds what one view reports: times and counters are summed.
void add_report(const FrameReport& view, DenoiseRecord& record);

/// One JSON object a line:
///   frame, cut    frame number; whether no history was taken over
///   stages        [{name, ms}], wall clock: read, kStageNames but the source, compose, write
///   new_pixels, surface_pixels, non_finite_pixels, clamped
class DenoiseLog {
 public:
  /// Keeps whole lines of an older log if `keeps`, else none. Throws std::runtime_error naming the
  /// file.
  DenoiseLog(std::filesystem::path path, bool keeps);

  /// Throws std::runtime_error naming the file if the line cannot be written.
  void append(const DenoiseRecord& record);

  /// The last line of each of `frames` that has one, in their order. Lines that are no JSON object
  /// with a frame, as of a write that was cut off, are left out.
  [[nodiscard]] static std::vector<nlohmann::json> read(const std::filesystem::path& path,
                                                        const std::vector<int>& frames);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace eigenlight
