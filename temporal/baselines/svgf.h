// Spatiotemporal variance-guided filtering, as published.
#pragma once

#include "temporal/baselines/blended_history.h"
#include "temporal/baselines/svgf_filter.h"

namespace eigenlight {

struct SvgfOptions {
  float alpha = 0.2f;          ///< (0, 1] least share of a frame in the history of its color
  float moments_alpha = 0.2f;  ///< (0, 1] and of its moments
  int passes = 5;              ///< [1, 6] a-trous passes
  int feedback = 1;            ///< [0, passes] the pass whose result becomes history; 0: none
  SvgfWeights weights = {};

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Schied et al. 2017, for comparison, on light over albedo. n is the number of frames in a pixel's
/// history with this one. For each frame:
///   1. color and moments of luminance are carried over through taps that show the same surface, or
///      their 3 x 3 surroundings where none does, and blended with
///      max(alpha, 1 / n) of this frame (section 4.1; 1 / n is of the authors' implementation);
///   2. the variance of luminance is m_2 - m_1^2; below 4 frames, moments and color come from a
///      7 x 7 cross-bilateral window, and the variance is multiplied by 4 / n (section 4.2; the
///      factor and the color are of the authors' implementation);
///   3. five a-trous passes steered by that variance; the color after the first becomes history
///      (section 4.3, svgf_filter.h).
/// n saturates at 32 frames. Samples that are not finite are ignored: their pixels keep their
/// history. Without history they are filled from the window, or are 0 if it is empty.
class Svgf final : public BlendedHistory {
 public:
  static constexpr float kMostFrames = 32.0f;
  static constexpr float kYoung = 4.0f;  ///< frames from which on the variance comes from history

  explicit Svgf(const DenoiserOptions& options, const SvgfOptions& parts = {});

 private:
  void blend_tile(const Tile& tile) override;
  [[nodiscard]] const Planes<3>& finish() override;
  void estimate(const Tile& tile);
  void estimate_from_window(glm::ivec2 p);
  void feed_back(const Tile& tile);

  SvgfOptions options_;
  SvgfImage image_, scratch_;  // bases of the history: color; m_1, m_2, 0
  Plane<float> known_;
};

}  // namespace eigenlight
