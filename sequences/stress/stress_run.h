// Runs of a denoiser on analytic frames, and the worst figure of a stress case.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sequences/stress/analytic_source.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Where to record the frames around one step of a case.
struct StressRecording {
  std::filesystem::path directory;
  int step = 0;  ///< of StressLog::steps()
};

/// The log of one execution of a case. Cases depend on the seed alone, so that an execution can be
/// repeated to record its worst frame.
class StressLog {
 public:
  explicit StressLog(std::uint32_t seed, std::optional<StressRecording> recording = {})
      : seed_(seed), recording_(std::move(recording)) {}

  [[nodiscard]] std::uint32_t seed() const { return seed_; }
  /// Frames denoised so far, over all runs.
  [[nodiscard]] int steps() const { return steps_; }

  /// Notes a figure of the last step and what it belongs to. The largest is kept; NaN is larger
  /// than all numbers.
  void note(double figure, std::string_view what = {});
  [[nodiscard]] double worst() const { return worst_; }
  [[nodiscard]] const std::string& worst_what() const { return worst_what_; }
  /// The step after which the worst figure was noted.
  [[nodiscard]] int worst_step() const { return worst_step_; }

 private:
  friend class StressRun;

  std::uint32_t seed_;
  std::optional<StressRecording> recording_;
  int steps_ = 0, worst_step_ = 0;
  double worst_ = 0.0;
  std::string worst_what_;
};

/// A denoiser on an analytic source.
class StressRun {
 public:
  /// The seed is mixed from `options.seed` and the seed of `log`, which must outlive the run.
  StressRun(StressLog& log, AnalyticOptions options, std::string_view method = "eigenlight",
            int bases = 3);

  /// Denoises one frame; null at the end.
  [[nodiscard]] const Planes<3>* step();
  /// Denoises all remaining frames and returns the last picture.
  [[nodiscard]] const Planes<3>& finish();
  [[nodiscard]] const Planes<3>& picture() const { return *picture_; }
  [[nodiscard]] const Frame& frame() const { return denoiser_->frame(); }
  [[nodiscard]] const FrameReport& report() const { return denoiser_->report(); }
  [[nodiscard]] const AnalyticSource& source() const { return source_; }
  [[nodiscard]] Denoiser& denoiser() { return *denoiser_; }
  [[nodiscard]] float truth(glm::ivec2 p, int channel) const {
    return source_.truth(p, channel, frame().index);
  }

 private:
  const Planes<3>* recorded_step();
  void write(std::string_view name) const;

  StressLog& log_;
  AnalyticSource source_;
  std::unique_ptr<Denoiser> denoiser_;
  const Planes<3>* picture_ = nullptr;
};

}  // namespace eigenlight
