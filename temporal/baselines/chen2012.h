// Spatio-temporal filtering by incremental PCA, as published.
#pragma once

#include "temporal/baselines/basis_history.h"
#include "temporal/baselines/chen2012_filter.h"
#include "temporal/baselines/chen2012_pca.h"
#include "temporal/denoiser.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

/// Variants that Chen 2012 compares.
struct ChenOptions {
  bool per_pixel_weights = true;  ///< else n of step 4 is that of the frames since the last cut
  bool basis_filter = true;       ///< step 5
};

/// Chen, Lei and Chang 2012, for comparison. Per frame:
///   1. bases and ages are carried over by reverse reprojection (section 3.4);
///   2. newly seen pixels get 120 more samples each (Fig. 6d); not at a cut, where all pixels are
///      new;
///   3. the warped bases are made orthogonal (Algorithm 2);
///   4. CCIPCA updates them with w = (1 + l) / n, amnesia l = 2, n the pixel's own age with this
///      frame (Algorithm 1, section 3.4.2);
///   5. bases are smoothed at newly seen pixels (Fig. 6c); at a cut, only where no sample is
///      usable;
///   6. the picture is the projection of the noisy frame on the *updated* bases.
/// Choices where the paper says nothing: w is at most 1, because (1 + l) / n of the first frames
/// would give history a negative weight. With w = 1 a new pixel starts at Algorithm 1's own u_i
/// (u_i . v_i / |v_i|): its v_1 reproduces its sample, and its other v_i the remainder. Ages
/// saturate at 255. Samples that are not finite are ignored.
class Chen2012 final : public Denoiser {
 public:
  static constexpr float kAmnesia = 2.0f;       ///< l; Weng 2003 takes 2 to 4
  static constexpr float kMostFrames = 255.0f;  ///< the paper has no limit
  static constexpr int kExtraSamples = 120;     ///< Fig. 6d

  explicit Chen2012(const DenoiserOptions& options, const ChenOptions& parts = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return age_; }
  void reset() override { history_.reset(); }
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  void find_new_pixels(const Tile& tile);
  void resample(FrameSource& source);
  void merge_samples(const Tile& tile, bool resampled);
  void weigh(const Tile& tile);

  ChenOptions options_;
  Frame frame_;
  FrameReport report_;
  BasisHistory history_;
  int number_ = 0;  // frames since the last cut, saturated as ages are

  ImagePca pca_;
  NewPixelFilter filter_;
  std::vector<PixelCounts> counts_;  // per tile
  Plane<std::uint8_t> extra_, smooth_;
  Planes<3> extra_mean_, light_, output_;
  Plane<float> old_age_, age_, weight_;
};

}  // namespace eigenlight
