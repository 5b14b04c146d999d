// Limits the influence of samples that are far brighter than history and neighbors predict.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "temporal/bases/tile_sums.h"

namespace eigenlight {

/// Side of a block in pixels.
inline constexpr int kFireflyBlock = 8;

struct FireflyOptions {
  /// [1, 1000] standard deviations that a sample may be off its prediction. Exponential noise goes
  /// beyond 8 with a chance of 0.012 %, and so loses 0.1 % of its light at most.
  float deviations = kOutlier;
  /// [1, 1000] largest brightness of a new pixel, over that of the light around it.
  float times = 16.0f;
  /// (0, 1] largest share of outliers around; if there are more, the light has changed.
  float share = 0.125f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct FireflyInputs {
  const Plane<float>& expected;  ///< luminance of the prediction; 0 without history
  const Plane<float>& age;       ///< n, of the history
  const Plane<float>& samples;   ///< s, this frame's samples over its regular number; 0: not usable
  const Plane<float>& variance;  ///< v, of one frame's luminance
};

/// Pixels of a block of 8 x 8.
struct FireflyBlock {
  int confirmed = 0;
  int outliers = 0;   ///< of the confirmed
  int usable = 0;     ///< with a sample
  int fresh = 0;      ///< usable, not confirmed
  double root = 0.0;  ///< sum of sqrt(luminance) of the usable
};

/// What the bound changes.
struct FireflyOutputs {
  Planes<3>& residual;       ///< light - prediction: the light itself where there is no history
  Plane<float>& innovation;  ///< luminance of the residual; NaN: not confirmed
};

/// Counts the pixels of a block whose left edge is a multiple of 8.
[[nodiscard]] FireflyBlock count_fireflies(const FireflyInputs& in, float deviations,
                                           const FireflyOutputs& out, const Rect& block);

/// Bounded influence (Huber 1964). A residual r of luminance, with
///   sigma^2 = v (1/s + 1/n) + (0.1 expected)^2,
/// is an outlier beyond `deviations` sigma. Where no more than `share` of the confirmed pixels in
/// the 3 x 3 blocks of 8 x 8 pixels around are outliers, and no more than twice as many of those in
/// the pixel's own block (an edge of light that moves has them side by side, fireflies have not),
///   - light is scaled back to min((n + s) / (s sqrt(n)), `deviations`) sigma from the prediction:
///     the mean of n + s samples moves by one of its own deviations, sigma / sqrt(n), at most;
///   - the pixel counts as not confirmed: the correction and the innovation test ignore it.
/// Where there are more outliers, the light itself has changed and nothing is bounded. A new pixel
/// may be `times` as bright as (mean sqrt(luminance))^2 over the usable pixels of those blocks,
/// which a few fireflies hardly change. Light that is bright in every frame is thus learned step by
/// step; light that was bright once leaves no trail.
class FireflyBound {
 public:
  /// Throws std::invalid_argument on a bad size or option.
  FireflyBound(Extent extent, const FireflyOptions& options);

  /// Counts the pixels of `area`, whose edges are multiples of 8 or those of the image. Call it for
  /// the whole image before bound(), in any order and on any thread.
  void count(const FireflyInputs& in, const FireflyOutputs& out, const Rect& area);
  /// Bounds the outliers and returns their number. Calls changed(block) for each block that it
  /// changed, on any thread; within a row of blocks from left to right.
  std::int64_t bound(const FireflyInputs& in, const FireflyOutputs& out,
                     const std::function<void(const Tile&)>& changed);
  /// The largest brightness of a new pixel in each block of 8 x 8; infinite in blocks without a new
  /// pixel nearby.
  [[nodiscard]] const Plane<float>& brightness() const { return brightness_; }

 private:
  /// Of a block and its neighbors.
  struct Region {
    bool is_steady;    // outliers are few
    bool is_fresh;     // there are new pixels
    float brightness;  // largest of a new pixel
  };

  [[nodiscard]] float deviation(const FireflyInputs& in, int x, int y) const;
  [[nodiscard]] float step(const FireflyInputs& in, int x, int y) const;
  [[nodiscard]] Region region(const Tile& tile) const;
  [[nodiscard]] int bound_block(const FireflyInputs& in, const Tile& tile,
                                const FireflyOutputs& out);

  FireflyOptions options_;
  TileGrid grid_;            // of blocks
  Plane<float> brightness_;  // of blocks
  std::vector<FireflyBlock> blocks_;
  std::vector<int> bounded_;  // per row of blocks
};

}  // namespace eigenlight
