// Twin of temporal/tile_sums: all sums in double, pixel by pixel, from the formula in the header.
#pragma once

#include <cmath>

#include "temporal/tile_sums.h"

namespace eigenlight::reference {

/// Rec. 709.
inline double luminance(double r, double g, double b) {
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

inline TileSums tile_sums(const SumInputs& in, const Tile& tile) {
  TileSums sums;
  const BasisField& v = in.bases;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const double n = v.age(x, y);
      double u[3], r[3];
      bool finite = true;
      for (int c = 0; c < 3; ++c) {
        u[c] = in.frame.indirect[static_cast<std::size_t>(c)](x, y);
        r[c] = u[c] - v.value(x, y, c, 0);
        finite = finite && std::abs(u[c]) <= kLargestLight;
      }
      if (!(n > 0.0) || !finite) continue;
      const double steady =
          luminance(v.value(x, y, 0, 0), v.value(x, y, 1, 0), v.value(x, y, 2, 0));
      const double m = n / (n + 1.0) / (in.variance(x, y) + 0.01 * steady * steady);
      sums.pixels += 1.0;
      for (int j = 0; j < v.bases(); ++j) {
        double along = 0.0;
        for (int c = 0; c < 3; ++c) along += v.value(x, y, c, j) * r[c];
        sums.innovation[static_cast<std::size_t>(j)] += m * along;
        sums.spread[static_cast<std::size_t>(j)] += m * m * along * along;
        for (int i = 0; i <= j; ++i) {
          double dot = 0.0;
          for (int c = 0; c < 3; ++c) {
            dot += static_cast<double>(v.value(x, y, c, i)) * v.value(x, y, c, j);
          }
          sums.gram[static_cast<std::size_t>(packed(i, j))] += m * dot;
        }
      }
    }
  }
  return sums;
}

}  // namespace eigenlight::reference
