// The reprojected running mean of every pixel.
#pragma once

#include "temporal/baselines/blended_history.h"

namespace eigenlight {

/// Reprojected running mean: mean <- mean + (u - mean) / n with n = min(age + 1, 32) frames, age
/// being that of the reprojected history. No spatial filter, no resampling. Reprojection warps
/// mean * age, so that taps weigh by their age and a pixel without any finite sample counts
/// nothing. A pixel that is not finite keeps its history. Without history it is 0 and stays new.
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
