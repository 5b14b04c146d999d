// Frames of other renderers, whose guides are as noisy as their light.
#pragma once

#include <vector>

#include "spatial/soft_atrous.h"
#include "temporal/eigen/eigen_denoiser.h"

namespace eigenlight {

struct SoftOptions {
  EigenOptions eigen;  ///< its own filters are turned off
  SoftAtrousOptions filter;
  /// (0, 100] standard deviations that count as the same light: of estimates over many frames, and
  /// of direct light, which is filtered frame by frame.
  float sigmas = 7.0f, direct_sigmas = 3.0f;

  SoftOptions();
};

/// Estimates of EigenDenoiser, filtered by SoftAtrous. There is one basis, whose gain is a ratio of
/// sums of light (even_sums.h), and no bound of fireflies: both cost light where samples are few
/// and heavy-tailed. Direct light has no history: where its edges move over surfaces, an estimate
/// of the past would drag them along.
class SoftDenoiser final : public Denoiser {
 public:
  /// Takes size and number of layers of `options`. Throws std::invalid_argument on bad ones.
  explicit SoftDenoiser(const DenoiserOptions& options, const SoftOptions& tuning = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] int layers() const { return static_cast<int>(outputs_.size()); }
  /// What step() made of a layer of light: radiance over its color.
  [[nodiscard]] const Planes<3>& output(int layer) const {
    return outputs_[static_cast<std::size_t>(layer)];
  }
  [[nodiscard]] const Frame& frame() const override { return eigen_.frame(); }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return eigen_.age(); }
  void reset() override { eigen_.reset(); }
  void save(StateWriter& out) const override { eigen_.save(out); }
  void load(StateReader& in) override { eigen_.load(in); }

 private:
  SoftOptions options_;
  EigenDenoiser eigen_;
  SoftAtrous filter_;
  std::vector<Planes<3>> outputs_;
  std::vector<Plane<float>> variances_;
  FrameReport report_;
};

}  // namespace eigenlight
