// The simplest history there is: every pixel's mean, carried along with its surface.
#pragma once

#include "temporal/baselines/blended_history.h"

namespace eigenlight {

/// Reprojected running mean: mean <- mean + (u - mean) / n with n = min(age + 1, 32) frames, age
/// being that of the reprojected history. No spatial filter, no resampling. Reprojection carries
/// mean * age, so that the four taps weigh by what stands behind them and a pixel that has yet to
/// see a finite sample gives nothing. A pixel that is not finite keeps its history, or is 0 and
/// stays new without one.
class RunningMean final : public BlendedHistory {
 public:
  /// Longest mean: that of the project's comparison table, about a second of film.
  static constexpr float kMostFrames = 32.0f;

  explicit RunningMean(const DenoiserOptions& options);

 private:
  void blend_tile(const Tile& tile) override;
  [[nodiscard]] const Planes<3>& finish() override { return output_; }

  Planes<3> output_;  // the one basis of the history is mean * age
};

}  // namespace eigenlight
