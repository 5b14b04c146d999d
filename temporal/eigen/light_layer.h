// One layer of light: its history and its steps of the frame loop.
#pragma once

#include "frame/ping_pong.h"
#include "frame/strips.h"
#include "reproject/basis_field.h"
#include "temporal/bases/coefficient_history.h"
#include "temporal/eigen/output_filter.h"
#include "temporal/eigen/shared_frame.h"

namespace eigenlight {

/// The state of one layer of light: bases and ages, the variance of its noise, the statistics of
/// its coefficients, the firefly bound, the correction, and the filter of its output. The functions
/// are called once a frame, in the order of their declarations.
class LightLayer {
 public:
  /// `index`: which of FrameInput::lights. Throws std::invalid_argument on a bad size or option.
  LightLayer(int index, const DenoiserOptions& options, const EigenOptions& tuning);

  // While the frame's surfaces are read.

  /// Reads the geometry of two rows for the cells of the correction.
  void place_cells(const SharedFrame& shared, const Rect& rows) {
    if (options_.correct) correction_.read_geometry(shared.frame().surface, rows);
  }

  // warp: history is reprojected to this frame, and the inner products of its tiles are summed.

  void start_warp(const SharedFrame& shared);
  /// Warps one row of a strip; empty tiles forget their history. `taps`: of each tile.
  void warp_row(const SharedFrame& shared, std::span<const TapSegment> taps, const Strip& row);
  /// Copies the ages of the history of one row of a strip.
  void read_ages(const Strip& row);
  void sum_products(const SharedFrame& shared, const Strip& band);
  void finish_warp(const SharedFrame& shared);
  [[nodiscard]] const Plane<float>& old_age() const { return old_age_; }

  /// resample: where the mean of the extra samples goes, until predict().
  [[nodiscard]] Planes<3>& extra_mean() { return residual_; }

  /// project: coefficients of the bases.
  void project();
  /// predict: samples are merged, light is predicted, the residual is computed, and fireflies and
  /// blocks of the correction are counted. All of this is done band by band, so that each part
  /// finds its input in the cache.
  void predict(const SharedFrame& shared, bool resampled);
  /// bound: fireflies are scaled back.
  void bound(const SharedFrame& shared);
  /// correct: what neighbors agree on and no basis explains. CellFilter ends this step.
  [[nodiscard]] CorrectionLayer prepare_correction(const SharedFrame& shared);
  /// learn: statistics of the coefficients, and whether a basis is born.
  void learn();
  /// update: the innovation test sets ages, and the bases are updated by the frame.
  void update(const SharedFrame& shared);

  // filter: the estimate becomes the picture.

  void fill_young(const SharedFrame& shared);
  /// What the a-trous passes filter in place.
  [[nodiscard]] AtrousImage image() {
    return {output_, output_variance_, filter_.earlier(old_age_)};
  }
  /// After the passes.
  void keep_picture() { filter_.keep(output_); }

  /// The picture: radiance over the layer's color.
  [[nodiscard]] const Planes<3>& output() const { return output_; }
  [[nodiscard]] const Plane<float>& variance() const { return output_variance_; }  ///< of output()
  [[nodiscard]] const Plane<float>& age() const { return new_age_; }
  /// Adds what this layer counted in this frame; the shared frame counts surfaces.
  void add_to(const SharedFrame& shared, FrameReport& report) const;

  void save(StateWriter& out) const;
  void load(StateReader& in);

 private:
  template <typename Body>
  void each_surface(const SharedFrame& shared, const Strip& band, Body&& body) const;
  [[nodiscard]] CorrectionInputs correction_inputs(const SharedFrame& shared) const;
  [[nodiscard]] float longest_age(const Tile& tile) const;
  void shorten_ages(const SharedFrame& shared, const Tile& tile);
  void make_room(int bases);
  void test_tile(const SharedFrame& shared, const Tile& tile);
  void update_row(const SharedFrame& shared, const Strip& row);
  void clear_tile(const Tile& tile);
  [[nodiscard]] double mean_rank(const SharedFrame& shared) const;

  int index_;
  EigenOptions options_;
  TileGrid tiles_;  // of coefficients

  // History. `before` is that of the last frame; `now` is the same reprojected to this frame, and
  // later updated by it.
  PingPong<BasisField> bases_;
  PingPong<Plane<float>> variance_;  // of one frame's luminance
  CoefficientHistory coefficient_history_;

  FireflyBound fireflies_;
  Correction correction_;
  OutputFilter filter_;
  CoefficientField coefficients_, learning_rates_;
  PerTile<TileSums> sums_;
  int newborn_ = 0;  // basis that is born in this frame, or 0

  PerTile<PixelCounts> counts_;  // fresh and non-finite ones
  std::int64_t bounded_ = 0, skipped_guided_ = 0;

  // This frame's light with its extra samples, until predict() subtracts the prediction.
  Planes<3> residual_;
  Plane<float> innovation_, expected_;  // luminance of the residual, and of the prediction
  Plane<float> samples_, old_age_, new_age_, output_variance_;
  Plane<std::uint8_t> young_;
  Planes<3> output_;
};

}  // namespace eigenlight
