// The simplest history there is: every pixel's mean, carried along with its surface.
#pragma once

#include "temporal/baselines/basis_history.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Reprojected running mean: mean <- mean + (u - mean) / n with n = min(age + 1, 32) frames, age
/// being that of the reprojected history. No spatial filter, no resampling. Reprojection carries
/// mean * age, so that the four taps weigh by what stands behind them and a pixel that has yet to
/// see a finite sample gives nothing. A pixel that is not finite keeps its history, or is 0 and
/// stays new without one.
class RunningMean final : public Denoiser {
 public:
  /// Longest mean: that of the project's comparison table, about a second of film.
  static constexpr float kMostFrames = 32.0f;

  explicit RunningMean(const DenoiserOptions& options);

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return age_; }
  void reset() override { history_.reset(); }
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  struct Counts {
    std::int64_t surface = 0, fresh = 0, non_finite = 0;
  };

  void update(const Tile& tile, Counts& counts);

  Frame frame_;
  FrameReport report_;
  BasisHistory history_;  // one basis: mean * age
  Planes<3> output_;
  Plane<float> age_;
  std::vector<Counts> counts_;  // per tile
};

}  // namespace eigenlight
