// Blockwise multi-order feature regression, as published.
#pragma once

#include "temporal/baselines/blended_history.h"

namespace eigenlight {

struct BmfrOptions {
  float alpha = 0.2f;         ///< (0, 1] least share of a frame in the noisy history
  float second_alpha = 0.1f;  ///< (0, 1] and of a fit in the history of fits
  float noise = 0.01f;        ///< (0, 1] amplitude of the noise on features

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Koskela et al. 2019, for comparison, on light over albedo. n is the number of frames in a
/// pixel's history with this one, at most 255. For each frame:
///   1. the noisy light is blended into its history with max(alpha, 1 / n) (section 3.1);
///   2. the blend is fitted with features block by block (bmfr_fit.h); the blocks are shifted in
///      every frame;
///   3. the fit is blended into its own history with max(second_alpha, 1 / n) (section 3.5).
/// The paper's last stage, antialiasing of the tone-mapped picture, is left out. Taps are those of
/// reproject/taps.h; the authors set limits on position and normal for each scene. Samples that are
/// not finite are ignored: their pixels keep their history. Without history they show the fit of
/// their block.
class Bmfr final : public BlendedHistory {
 public:
  static constexpr float kMostFrames = 255.0f;

  explicit Bmfr(const DenoiserOptions& options, const BmfrOptions& parts = {});

 private:
  void blend_tile(const Tile& tile) override;
  [[nodiscard]] const Planes<3>& finish() override;
  void blend_fit(const Tile& tile);

  BmfrOptions options_;
  Planes<3> light_, output_;  // bases of the history: noisy light, fits
};

}  // namespace eigenlight
