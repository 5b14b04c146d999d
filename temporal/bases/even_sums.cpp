#include "temporal/bases/even_sums.h"

#include <cmath>

#include "frame/luminance.h"

namespace eigenlight {

void accumulate_even(const SumInputs& history, const Tile& part, TileSums& sums) {
  for (int y = part.y0; y < part.y1; ++y) {
    for (int x = part.x0; x < part.x1; ++x) {
      const double age = static_cast<double>(*history.bases.ages(x, y));
      const double now = static_cast<double>(luminance(history.light, x, y));
      if (!(age > 0.0) || !(std::abs(now) <= static_cast<double>(kLargestLight))) continue;
      const double before = static_cast<double>(luminance(history.bases.value(x, y, 0, 0),
                                                          history.bases.value(x, y, 1, 0),
                                                          history.bases.value(x, y, 2, 0)));
      const double m = age / (age + 1.0), r = now - before;
      sums.gram[0] += m * before;
      sums.innovation[0] += m * r;
      sums.scatter_rr[0] += m * m * r * r;
      sums.scatter_r0[0] += m * m * r * before;
      sums.scatter_00[0] += m * m * before * before;
      sums.pixels += 1.0;
    }
  }
}

}  // namespace eigenlight
