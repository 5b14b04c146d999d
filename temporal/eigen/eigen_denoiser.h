// Our method: reprojected incremental PCA with leave-one-out coefficients per tile.
#pragma once

#include <deque>

#include "temporal/denoiser.h"
#include "temporal/eigen/light_layer.h"
#include "temporal/eigen/shared_frame.h"

namespace eigenlight {

/// The frame loop. Its steps have the names of Stage; docs/method.md has their equations. The
/// filtered picture is the output. History stays unfiltered, so that blur does not accumulate. The
/// next frame's filter reads the picture only to compute its weights.
///
/// SharedFrame computes the geometry of a frame once; LightLayer holds everything else, once for
/// each layer of light. The a-trous passes filter all layers in one visit.
class EigenDenoiser final : public Denoiser {
 public:
  /// Throws std::invalid_argument on a bad size, option, or number of bases or layers.
  explicit EigenDenoiser(const DenoiserOptions& options, const EigenOptions& tuning = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] int layers() const { return static_cast<int>(layers_.size()); }
  /// The denoised layer: radiance over its color.
  [[nodiscard]] const Planes<3>& output(int layer) const { return at(layer).output(); }
  /// Variance of the luminance of output(layer).
  [[nodiscard]] const Plane<float>& variance(int layer) const { return at(layer).variance(); }
  [[nodiscard]] const Frame& frame() const override { return shared_.frame(); }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  /// Ages of the first layer.
  [[nodiscard]] const Plane<float>& age() const override { return layers_.front().age(); }
  /// Frames that output(layer) holds.
  [[nodiscard]] const Plane<float>& age(int layer) const { return at(layer).age(); }
  void reset() override { shared_.reset(); }
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  [[nodiscard]] bool read(FrameSource& source);
  void warp();
  void warp_row(const Strip& row);
  void find_lowest_age(const Rect& row);
  [[nodiscard]] const Plane<float>& lowest_age() const {
    return layers() == 1 ? layers_.front().old_age() : lowest_age_;
  }
  void resample(FrameSource& source, std::int64_t planned);
  void correct();
  void filter();
  void finish_report();
  [[nodiscard]] const LightLayer& at(int layer) const {
    return layers_[static_cast<std::size_t>(layer)];
  }

  EigenOptions options_;
  SharedFrame shared_;
  CellFilter cell_filter_;
  std::deque<LightLayer> layers_;
  FrameReport report_;
  bool resampled_ = false;
  Plane<float> lowest_age_;  // over all layers, where there is more than one
  Atrous atrous_;            // of all layers
};

}  // namespace eigenlight
