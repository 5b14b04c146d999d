// Operations that the formulas of the filters ask for, an addition and a multiplication being one
// each: what no implementation can do without, however it arranges them.
#pragma once

#include "spatial/atrous.h"
#include "spatial/soft_atrous.h"
#include "tests/bench/floors.h"

namespace eigenlight {

/// Per tap of atrous.h: distance off the plane 6, luminance and its difference 6, their decay 4,
/// the cosine 5, the powers of both 3 + 1 + 3, kernel 1, and color 6, weight 1 and variance 3
/// summed up.
[[nodiscard]] inline double atrous_flops(const AtrousOptions& options) {
  return 39.0 * options.passes * 8;
}

/// Per tap of soft_atrous.h: geometry 20 + 5, comparison of light 4 + 5, weights 2, and sums of
/// weight 1, color 6 and variance 3; per pixel of a mean 8 weights of geometry, which are shared,
/// and 9 times 8.
[[nodiscard]] inline double soft_atrous_flops(const SoftAtrousOptions& options) {
  const int taps = options.radius == 1 ? 8 : 24;
  return options.passes * (46.0 * taps + 9.0 * 8);
}

/// guided_filter.h with 4 guides and 3 channels: 30 sums for the fits and 16 of coefficients, each
/// a running sum of 2 additions along both axes, 184; products with weights 7, guides 10 and
/// signals 12, 29; means and covariances 30 + 44; factors 34; three solutions 84 and offsets 24;
/// the output
/// 27. Without the radius: running sums do not ask for it.
inline constexpr Work kGuidedWork{9 * 4 + 1, 3 * 4, 456.0};

}  // namespace eigenlight
