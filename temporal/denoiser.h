// The face of every method that turns noisy frames into steady ones.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frame/frame.h"
#include "frame/state.h"

namespace eigenlight {

/// The steps of the frame loop, in their order (docs/method.md). A method reports those that it
/// has.
enum class Stage {
  kSource,    ///< a frame is read
  kWarp,      ///< history is brought to where its surfaces are now
  kBudget,    ///< extra samples are planned
  kResample,  ///< and drawn
  kProject,   ///< coefficients of the bases
  kPredict,   ///< the light that they foresee, and the residual
  kBound,     ///< fireflies are scaled back
  kCorrect,   ///< what neighbors agree on and no basis explains
  kLearn,     ///< statistics of the coefficients
  kUpdate,    ///< the innovation test, and bases take the frame in
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

/// What happened in one frame; one line of frames.jsonl.
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
  /// What was skipped, in pixels.
  std::int64_t skipped_warp = 0;        ///< still: no taps, no copy
  std::int64_t skipped_surface = 0;     ///< pixels in tiles without any surface
  std::int64_t skipped_filter = 0;      ///< pixels already quiet enough for the spatial passes
  std::int64_t skipped_geometry = 0;    ///< pixels in one plane with all taps of a spatial pass
  std::int64_t skipped_guided = 0;      ///< pixels in tiles without young pixels
  std::int64_t skipped_correction = 0;  ///< pixels around which no light changed unforeseen

  [[nodiscard]] StageTime& operator[](Stage stage) { return time[static_cast<std::size_t>(stage)]; }
  [[nodiscard]] const StageTime& operator[](Stage stage) const {
    return time[static_cast<std::size_t>(stage)];
  }
};

class Denoiser {
 public:
  virtual ~Denoiser() = default;

  /// Pulls one frame from `source` and denoises its layers of light. Returns the first: radiance
  /// over its color, linear, 0 without surface; valid until the next call. Null at the end of the
  /// sequence. Throws std::invalid_argument if the frame has another size or number of layers than
  /// the denoiser.
  [[nodiscard]] virtual const Planes<3>* step(FrameSource& source) = 0;

  [[nodiscard]] virtual const Frame& frame() const = 0;         ///< the one that step() pulled last
  [[nodiscard]] virtual const FrameReport& report() const = 0;  ///< of the last step()
  /// Frames' worth of samples behind each pixel; 0 without surface.
  [[nodiscard]] virtual const Plane<float>& age() const = 0;

  virtual void reset() = 0;  ///< forgets all history, as at a cut

  /// History between two frames. After load() the next step() gives the same bits as if the process
  /// had never ended. load() throws std::runtime_error on data that is not such a state.
  virtual void save(StateWriter& out) const = 0;
  virtual void load(StateReader& in) = 0;
};

struct DenoiserOptions {
  Extent extent;
  int bases = 3;   ///< [1, 8] K, for methods that have bases
  int layers = 1;  ///< [1, kMaxLights] layers of light in each frame, for `eigenlight`
  /// Parts of the method to turn off, by name, to see what each is worth.
  std::vector<std::string> without = {};
};

/// A part of a method that can be turned off.
struct Part {
  std::string_view name;
  std::string_view what;  ///< one line: what happens without it
};

}  // namespace eigenlight
