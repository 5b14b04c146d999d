// Ours: reprojected incremental PCA with leave-one-out coefficients per tile.
#pragma once

#include <vector>

#include "reproject/basis_field.h"
#include "reproject/surface_history.h"
#include "temporal/bases/light_memory.h"
#include "temporal/denoiser.h"
#include "temporal/eigen/eigen_options.h"
#include "temporal/eigen/output_filter.h"

namespace eigenlight {

/// The frame loop of design section 4. Per frame:
///   warp bases, ages and variances through validated taps; sum the tiles' inner products on the
///   way; give young pixels more samples; solve the coefficients on the warped bases; predict; test
///   the residual; update the bases; filter the estimate spatially, by its variance.
/// The filtered picture is the output; the history stays unfiltered, so that blur never adds up.
/// The next frame's filter reads the picture for its weights alone.
class EigenDenoiser final : public Denoiser {
 public:
  explicit EigenDenoiser(const DenoiserOptions& options, const EigenOptions& parts = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return new_age_; }
  void reset() override {
    surfaces_.reset();
    is_taken_ = true;
  }
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  void start_frame(const StageTime& time);
  void count_surface(const Tile& row);
  void drop_unusable(const Tile& row);
  [[nodiscard]] bool is_empty(const Tile& tile) const;
  void warp_history();
  void warp_row(const Tile& row);
  [[nodiscard]] bool resample(FrameSource& source, std::int64_t planned);
  void project(bool resampled);
  [[nodiscard]] CorrectionInputs correction_inputs() const;
  void predict(bool resampled);
  void report_rank();
  [[nodiscard]] float longest_age(int tile) const;
  void shorten_memory(const Tile& tile);
  void update();
  void update_row(const Tile& row);
  void clear_tile(const Tile& tile);
  void filter();

  struct TileCount {
    std::int64_t surface = 0, fresh = 0, non_finite = 0, unguided = 0;
  };

  EigenOptions options_;
  Extent extent_;
  TileGrid tiles_;  // of coefficients
  Frame frame_;
  bool is_taken_ = true;  // frame_ is in surfaces_, or there is none
  FrameReport report_;

  // History: warped and variance hold that of the frame before, brought to this one. Bases have
  // room for those in use only.
  SurfaceHistory surfaces_;
  BasisField bases_, warped_bases_;
  Plane<float> variance_, warped_variance_;  // of one frame's luminance
  LightMemory memory_;

  // Scratch, and what the last frame left for the caller.
  SampleBudget budget_;
  FireflyBound fireflies_;
  Correction correction_;
  OutputFilter filter_;
  CoefficientField coefficients_, learning_;
  std::vector<TileSums> sums_;
  int newborn_ = 0;
  bool has_edges_ = false;  // in edge_
  std::vector<TileCount> counts_;
  Plane<std::uint8_t> extra_, edge_, young_;
  // This frame's light, resampling included, until predict() takes from it what history expects.
  Planes<3> residual_;
  Plane<float> innovation_, expected_;  // luminance of the residual, and of the prediction
  Planes<3> output_;
  Plane<float> samples_, old_age_, new_age_, output_variance_;
};

}  // namespace eigenlight
