// Sums over the frames of a run, for its summary.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "sequences/runs/run_log.h"
#include "temporal/frame_report.h"

namespace eigenlight {

/// Sums over the frames that one process rendered.
struct RunTotals {
  std::size_t frames = 0;
  std::int64_t rays = 0;
  std::int64_t non_finite = 0;  ///< pixels and samples excluded
  double seconds = 0.0;
  std::array<StageTime, kStageNames.size()> time{};
  StageTime write, antialias, direct;

  void add(const FrameReport& report, const FrameOutput& output);
  /// Wall time of the stages that trace rays, source and resample.
  [[nodiscard]] double render_ms() const;
  /// Million rays per second of render_ms().
  [[nodiscard]] double mega_rays_per_second() const;
  /// `frames`, `seconds`, `mrays_per_second`, `mean_ms` ({stage: {wall, cpu}}), `non_finite`,
  /// `directory`, as one line of JSON.
  [[nodiscard]] std::string to_json(const std::filesystem::path& directory) const;
  /// The summary for people: one line, and a second one if samples or pixels were excluded.
  [[nodiscard]] std::string to_text(const std::filesystem::path& directory) const;
};

}  // namespace eigenlight
