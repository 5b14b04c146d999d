// What a stress case works with: runs of a denoiser on analytic frames, and a record of the worst
// that was seen.
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

/// Where to write what happened around one step of a case.
struct StressRecording {
  std::filesystem::path directory;
  int step = 0;  ///< of Lab::steps()
};

/// One execution of a case. Cases are functions of the seed alone, so that an execution can be
/// repeated to record the frame at which it was worst.
class Lab {
 public:
  explicit Lab(std::uint32_t seed, std::optional<StressRecording> recording = {})
      : seed_(seed), recording_(std::move(recording)) {}

  [[nodiscard]] std::uint32_t seed() const { return seed_; }
  /// Frames denoised so far, over all runs.
  [[nodiscard]] int steps() const { return steps_; }

  /// Notes a figure of the last step; the largest is kept, and NaN is larger than all.
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
  /// `options.seed` is replaced by one that depends on it and on the seed of the lab, which must
  /// outlive the run.
  StressRun(Lab& lab, AnalyticOptions options, std::string_view method = "eigenlight",
            int bases = 3);

  /// Denoises one frame; null at the end.
  [[nodiscard]] const Planes<3>* step();
  /// All frames up to the last; the picture of that.
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

  Lab& lab_;
  AnalyticSource source_;
  std::unique_ptr<Denoiser> denoiser_;
  const Planes<3>* picture_ = nullptr;
};

}  // namespace eigenlight
