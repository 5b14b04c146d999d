// The steps of the frame loop, and what a denoiser reports of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace eigenlight {

/// The steps of the frame loop in order (docs/method.md). A method reports the steps that it has.
enum class Stage {
  kSource,    ///< a frame is read
  kWarp,      ///< history is reprojected to this frame
  kBudget,    ///< extra samples are planned
  kResample,  ///< extra samples are drawn
  kProject,   ///< coefficients of the bases
  kPredict,   ///< the light predicted from history, and the residual
  kBound,     ///< fireflies are scaled back
  kCorrect,   ///< the smoothed residual is added
  kLearn,     ///< statistics of the coefficients
  kUpdate,    ///< the innovation test; bases are updated by the frame
  kFilter,    ///< spatial filters
  kCount
};
inline constexpr std::array<std::string_view, static_cast<std::size_t>(Stage::kCount)> kStageNames{
    "source", "warp",    "budget", "resample", "project", "predict",
    "bound",  "correct", "learn",  "update",   "filter"};

struct StageTime {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;  ///< of the whole process

  StageTime& operator+=(const StageTime& other) {
    wall_ms += other.wall_ms;
    cpu_ms += other.cpu_ms;
    return *this;
  }
};

/// What happened in one frame; one line of frames.jsonl. A new counter is a member here and a line
/// in kFrameCounters or kSkipCounters, which logs and pages read.
struct FrameReport {
  int frame = 0;
  bool cut = false;  ///< no history was taken over
  std::array<StageTime, static_cast<std::size_t>(Stage::kCount)> time{};
  std::int64_t rays = 0;  ///< of indirect and direct light and guide rays
  std::int64_t surface_pixels = 0;
  std::int64_t new_pixels = 0;          ///< surface pixels without history
  std::int64_t extra_samples = 0;       ///< granted by the budget
  std::int64_t non_finite_pixels = 0;   ///< raw pixels with NaN or Inf: excluded
  std::int64_t non_finite_samples = 0;  ///< excluded by the source itself
  std::int64_t unguided_pixels = 0;     ///< surfaces without usable normal or depth: unfiltered
  std::int64_t bounded_pixels = 0;      ///< fireflies, whose light was scaled back
  double mean_rank = 0.0;               ///< bases in use per tile with surface
  // Work that was skipped, in pixels: kSkipCounters says what.
  std::int64_t skipped_warp = 0;
  std::int64_t skipped_surface = 0;
  std::int64_t skipped_filter = 0;
  std::int64_t skipped_geometry = 0;
  std::int64_t skipped_guided = 0;
  std::int64_t skipped_correction = 0;

  [[nodiscard]] StageTime& operator[](Stage stage) { return time[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] const StageTime& operator[](Stage stage) const {
    return time[static_cast<std::size_t>(stage)];
  }
};

/// A counter of a report and its name in frames.jsonl.
struct FrameCounter {
  std::string_view name;
  std::int64_t FrameReport::*value;
};
inline constexpr std::array kFrameCounters{
    FrameCounter{"rays", &FrameReport::rays},
    FrameCounter{"surface_pixels", &FrameReport::surface_pixels},
    FrameCounter{"new_pixels", &FrameReport::new_pixels},
    FrameCounter{"extra_samples", &FrameReport::extra_samples},
    FrameCounter{"non_finite_pixels", &FrameReport::non_finite_pixels},
    FrameCounter{"non_finite_samples", &FrameReport::non_finite_samples},
    FrameCounter{"unguided_pixels", &FrameReport::unguided_pixels},
    FrameCounter{"bounded_pixels", &FrameReport::bounded_pixels},
};

/// A counter of pixels for which work was skipped.
struct SkipCounter {
  std::string_view name;  ///< below "skipped" in frames.jsonl
  std::string_view text;  ///< one line: which step, and where
  std::int64_t FrameReport::*value;
};
inline constexpr std::array kSkipCounters{
    SkipCounter{"warp", "warp: nothing moved", &FrameReport::skipped_warp},
    SkipCounter{"surface", "all steps: tile without a surface", &FrameReport::skipped_surface},
    SkipCounter{"filter", "a-trous passes: variance is low enough", &FrameReport::skipped_filter},
    SkipCounter{"geometry",
                "edge weights of the first a-trous pass: pixel and taps lie in one plane",
                &FrameReport::skipped_geometry},
    SkipCounter{"guided", "guided filter: tile without young pixels", &FrameReport::skipped_guided},
    SkipCounter{"correction", "correction: no unexpected change of light nearby",
                &FrameReport::skipped_correction},
};

}  // namespace eigenlight
