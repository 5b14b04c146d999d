// Methods without memory: each frame as it is, or through a spatial filter.
#pragma once

#include <memory>
#include <string>

#include "spatial/rivals/spatial_filter.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Filters the raw indirect light with `filter`, or returns it unchanged if `filter` is null
/// (`noisy`). There is no history and no resampling; age is 1 on every surface. Pixels with NaN or
/// Inf in any channel are excluded and counted: they are 0 in the signal, with weight 0. All
/// surface pixels count as new in the report, because none has a history.
class FrameByFrame final : public Denoiser {
 public:
  /// `name`: of the method; it is saved in its states.
  FrameByFrame(const DenoiserOptions& options, std::string_view name,
               std::unique_ptr<SpatialFilter> filter = nullptr);

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return age_; }
  void reset() override {}
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  void take_signal();

  std::string name_;
  std::unique_ptr<SpatialFilter> filter_;
  Frame frame_;
  Planes<3> signal_, filtered_;
  Plane<float> weight_;  // 1 where the signal may be used
  Plane<float> age_;
  FrameReport report_;
};

}  // namespace eigenlight
