// Which pixels deserve more samples.
#pragma once

#include <cstdint>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "spatial/sample_budget_kernel.h"

namespace eigenlight {

struct BudgetOptions {
  /// [0, 100] times the frame's own samples that a frame may add.
  double share = 1.0;
  /// [0, 255] samples added at one pixel: Chen 2012, Fig. 6, takes 120 at newly unoccluded pixels.
  int most_per_pixel = 120;
  /// [1, 255] frames' worth of samples after which a pixel is left alone.
  float enough = 18.0f;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

struct BudgetStats {
  std::int64_t samples = 0;  ///< granted
  std::int64_t pixels = 0;   ///< that get any
  float level = 0.0f;        ///< frames' worth of samples that every pixel reaches
};

/// Fills the youngest pixels first (water filling), in whole samples:
///   extra(p) = min(max(0, spp * (level - 1) - round(spp * age(p))), most_per_pixel)
/// with the highest level <= enough at which the sum stays within share * spp * (surface pixels).
/// `age` counts the history without this frame, so that a pixel holds age + 1 + extra / spp frames'
/// worth afterwards. Pixels without surface get none.
class SampleBudget {
 public:
  SampleBudget(Extent extent, const BudgetOptions& options);

  /// Throws std::invalid_argument if extents differ.
  BudgetStats process(const FrameInput& frame, const Plane<float>& age, Plane<std::uint8_t>& extra);

 private:
  /// Samples at which a pixel is left alone, whatever the budget.
  [[nodiscard]] int highest(int spp) const;
  [[nodiscard]] int find_level(const AgeHistogram& pixels, std::int64_t limit, int spp) const;

  BudgetOptions options_;
  TileGrid grid_;
  PerTile<AgeHistogram> histograms_;  // of strips of rows
};

}  // namespace eigenlight
