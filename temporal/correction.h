// What the bases cannot explain but many neighbors agree on is added to the history at once.
#pragma once

#include "frame/frame.h"
#include "spatial/atrous.h"
#include "temporal/coefficients.h"

namespace eigenlight {

struct CorrectionOptions {
  /// [0, 1000] variances of the smoothed residual that count as chance.
  float significance = 6.0f;
  int passes = 4;  ///< [1, 6] of the a-trous filter that smooths the residual
  int radius = 2;  ///< 1 or 2: its kernel

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct CorrectionInputs {
  const Frame& guides;
  const Planes<3>& light;         ///< u
  const Plane<float>& confirmed;  ///< 1 where there is history and u is usable, else 0
  const Plane<float>& age;        ///< n, of the history
  const Plane<float>& samples;    ///< s, this frame's samples over its regular number
  const Plane<float>& variance;   ///< v, of one frame's luminance
};

/// The smoothed innovation. r = u - prediction has variance v (1/s + 1/n); an edge-avoiding filter
/// that looks at geometry only turns it into m with variance q, and
///   correction = m f g,   f = max(0, 1 - significance * q / luminance(m)^2), averaged over 5 x 5,
/// goes to the prediction. A light that changes in a way no basis knows yet is so followed within
/// the frame, by its spatial smoothness instead of its history.
///
/// g in [0, 1] opens where light does change: it grows with the share of 8 x 8 blocks whose mean
/// residual exceeds two of its standard deviations, over a coefficient tile and its neighbors,
/// interpolated between tiles. Where it is closed nothing is filtered.
class Correction {
 public:
  Correction(Extent extent, const CorrectionOptions& options);

  /// Adds to `prediction`, subtracts from `residual` (luminance of u - prediction), and leaves what
  /// it added in correction(). Returns the share of confirmed pixels corrected by more than half.
  double process(const CorrectionInputs& in, Planes<3>& prediction, Plane<float>& residual);
  [[nodiscard]] const Planes<3>& correction() const { return smooth_; }
  /// Pixels of the last frame that were not filtered because no light changed around them.
  [[nodiscard]] std::int64_t skipped() const { return skipped_; }

 private:
  /// Blocks of a coefficient tile: those with enough confirmed pixels, and the significant ones.
  struct Blocks {
    int all = 0, significant = 0;
  };

  [[nodiscard]] Blocks test_blocks(const CorrectionInputs& in, const Plane<float>& residual,
                                   const Tile& tile) const;
  [[nodiscard]] bool open_gates();
  void choose_tiles();
  void load_residual(const CorrectionInputs& in, const Planes<3>& prediction, const Tile& tile);
  void find_factor(const Tile& tile);
  void apply(const CorrectionInputs& in, const Tile& tile, Planes<3>& prediction,
             Plane<float>& residual);

  CorrectionOptions options_;
  TileGrid grid_;
  Atrous filter_;
  Planes<3> smooth_;
  Plane<float> noise_, factor_;
  CoefficientField gate_;                            // g - 1 per tile
  std::vector<Blocks> blocks_;                       // per coefficient tile
  std::vector<std::uint8_t> wanted_;                 // per stage tile
  std::vector<std::int64_t> confirmed_, corrected_;  // pixels per coefficient tile
  std::int64_t skipped_ = 0;
  bool is_zero_ = true;  // smooth_ holds zeros
};

}  // namespace eigenlight
