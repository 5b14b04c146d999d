// Method `noisy`: the frames as they are. What every other method is compared against.
#pragma once

#include "temporal/denoiser.h"

namespace eigenlight {

/// Hands the raw indirect light through. No history, no resampling; age is 1 on every surface.
/// Pixels with NaN or Inf in any channel are excluded: 0 in the output, and counted. Surface pixels
/// all count as new in the report, because none has a history.
class PassThrough final : public Denoiser {
 public:
  explicit PassThrough(const DenoiserOptions& options);

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return age_; }
  void reset() override {}
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  Frame frame_;
  Planes<3> output_;
  Plane<float> age_;
  FrameReport report_;
};

}  // namespace eigenlight
