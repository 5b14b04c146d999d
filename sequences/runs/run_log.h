// frames.jsonl: how each frame of a run went.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "render/antialias/picture.h"
#include "temporal/frame_report.h"

namespace eigenlight {

/// Time and statistics of a frame after it was denoised.
struct FrameOutput {
  StageTime write;
  StageTime antialias = {};
  PictureStats picture = {};
  StageTime direct = {};  ///< direct light was denoised
};

/// One JSON object per frame, in the order of the run.
///   frame, cut   frame number; whether no history was taken over
///   stages       {name: {wall_ms, cpu_ms}} of kStageNames, "direct", "antialias" and
///                "write"
///   antialias    {rays, unmatched, non_finite} of the picture: PictureStats
///   samples      of indirect light: spp * surface_pixels + extra_samples
///   new_share    new_pixels / surface_pixels; 0 without surface
///   rank         mean number of bases in use per tile with surface
///   skipped      {name: pixels} of kSkipCounters
/// and the counters of kFrameCounters by their names; rays are those before antialiasing.
class RunLog {
 public:
  /// Keeps the first `kept` lines of an older log and drops all others. Throws BadFile naming the
  /// file and line if they are not those of the first `kept` of `frames`, std::runtime_error if the
  /// file cannot be read or written.
  RunLog(const std::filesystem::path& directory, const std::vector<int>& frames, std::size_t kept);

  /// Appends the line of a frame. Throws std::runtime_error naming the file if it cannot be
  /// written.
  void append(const FrameReport& report, int spp, const FrameOutput& output);

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace eigenlight
