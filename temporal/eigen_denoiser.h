// Ours: reprojected incremental PCA with leave-one-out coefficients per tile.
#pragma once

#include <vector>

#include "reproject/basis_field.h"
#include "reproject/surface_history.h"
#include "spatial/atrous.h"
#include "spatial/guided_filter.h"
#include "spatial/sample_budget.h"
#include "temporal/coefficients.h"
#include "temporal/correction.h"
#include "temporal/denoiser.h"
#include "temporal/firefly_bound.h"
#include "temporal/innovation.h"
#include "temporal/light_memory.h"

namespace eigenlight {

struct EigenOptions {
  TapOptions taps;
  ShrinkOptions shrink;
  FireflyOptions fireflies;
  CorrectionOptions correction;
  InnovationOptions innovation;
  BudgetOptions budget;
  GuidedOptions guided;
  AtrousOptions atrous{.passes = 4, .radius = 1, .luminance_sigmas = 7.0f};
  /// [0, 255] frames: younger pixels take the guided filter's value the more, the younger they are.
  float young = 2.0f;
  /// [1, 255] frames: the longest age where light changes in ways that no basis knows. A filter
  /// takes noise from the estimate later, but not what an old light left in it.
  float changing = 12.0f;
  /// [1, 255] frames: the longest age at edges whose history is blended (edges.h);
  /// where light changes, two thirds of that of the pixels around, if that is less. From the
  /// longest age of all on, edges are like other pixels.
  float edge = 12.0f;
  /// [0, 1] of the squared luminance: a tile whose variances all lie below it is not filtered.
  float quiet = 1e-5f;
  /// [0, 1] of the pixels that must need correction before another basis is born.
  double birth = 0.1;
  bool project = true;     ///< solve for coefficients; else the light is taken to be steady
  bool correct = true;     ///< add the smoothed innovation
  bool filter = true;      ///< a-trous passes over the output
  bool look_back = true;   ///< they tell edges of light by the last output as well
  bool skip_still = true;  ///< no taps for frames in which nothing moves
  bool skip_empty = true;  ///< no work in tiles without surface

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// The frame loop of design section 4. Per frame:
///   warp bases, ages and variances through validated taps; sum the tiles' inner products on the
///   way; give young pixels more samples; solve the coefficients on the warped bases; predict; test
///   the residual; update the bases; filter the estimate spatially, by its variance.
/// The filtered picture is the output only: the history stays unfiltered, so that blur never adds
/// up.
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
  void fill_young();
  void fill_earlier();

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
  Plane<float> shown_, earlier_;             // luminance of the last output, and brought here
  LightMemory memory_;

  // Scratch, and what the last frame left for the caller.
  SampleBudget budget_;
  FireflyBound fireflies_;
  Correction correction_;
  GuidedFilter guided_;
  Atrous atrous_;
  CoefficientField coefficients_, learning_;
  std::vector<TileSums> sums_;
  int newborn_ = 0;
  bool has_edges_ = false;  // in edge_
  std::vector<TileCount> counts_;
  Plane<std::uint8_t> extra_, edge_, young_;
  // This frame's light, resampling included, until predict() takes from it what history expects.
  Planes<3> residual_;
  Plane<float> innovation_, expected_;  // luminance of the residual, and of the prediction
  Planes<3> guided_light_, output_;
  Plane<float> samples_, old_age_, new_age_, output_variance_;
};

}  // namespace eigenlight
