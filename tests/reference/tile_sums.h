// Twin of temporal/bases/tile_sums: all sums in double, pixel by pixel, from the formula in the
// header.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "temporal/bases/tile_sums.h"

namespace eigenlight::reference {

/// Rec. 709.
inline double luminance(double r, double g, double b) {
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/// One pixel's weight before outliers are held back, and its residual.
struct SumPixel {
  double weight = 0.0, r[3] = {};
};

inline SumPixel sum_pixel(const SumInputs& in, int x, int y) {
  const BasisField& v = in.bases;
  SumPixel pixel;
  bool finite = true;
  for (int c = 0; c < 3; ++c) {
    const double u = in.light[static_cast<std::size_t>(c)](x, y);
    pixel.r[c] = u - v.value(x, y, c, 0);
    finite = finite && std::abs(u) <= kLargestLight;
  }
  const double n = v.age(x, y);
  if (!(n > 0.0) || !finite) return {};
  const double steady = luminance(v.value(x, y, 0, 0), v.value(x, y, 1, 0), v.value(x, y, 2, 0));
  pixel.weight = n / (n + 1.0) / (in.variance(x, y) + 0.01 * steady * steady);
  return pixel;
}

/// How far beyond the bound a pixel is: its weight is to be divided by this where it exceeds 1.
inline double sum_excess(const SumPixel& pixel) {
  const double off = luminance(pixel.r[0], pixel.r[1], pixel.r[2]) / kOutlier;
  return pixel.weight * off * off;
}

/// The pixels of a tile, row by row, few outliers held back.
inline std::vector<SumPixel> sum_pixels(const SumInputs& in, const Rect& tile) {
  std::vector<SumPixel> pixels;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) pixels.push_back(sum_pixel(in, x, y));
  }
  int used = 0, outliers = 0;
  for (const SumPixel& pixel : pixels) {
    used += pixel.weight > 0.0 ? 1 : 0;
    outliers += sum_excess(pixel) > 1.0 ? 1 : 0;
  }
  if (8 * outliers > used) return pixels;
  for (SumPixel& pixel : pixels) pixel.weight /= std::max(1.0, sum_excess(pixel));
  return pixels;
}

inline TileSums tile_sums(const SumInputs& in, const Rect& tile) {
  TileSums sums;
  const BasisField& v = in.bases;
  const std::vector<SumPixel> pixels = sum_pixels(in, tile);
  auto next = pixels.begin();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const auto& [m, r] = *next++;
      if (!(m > 0.0)) continue;
      sums.pixels += 1.0;
      for (int j = 0; j < v.bases(); ++j) {
        double along = 0.0, first = 0.0;
        for (int c = 0; c < 3; ++c) {
          along += v.value(x, y, c, j) * r[c];
          first += static_cast<double>(v.value(x, y, c, j)) * v.value(x, y, c, 0);
        }
        sums.innovation[static_cast<std::size_t>(j)] += m * along;
        sums.scatter_rr[static_cast<std::size_t>(j)] += m * m * along * along;
        sums.scatter_r0[static_cast<std::size_t>(j)] += m * m * along * first;
        sums.scatter_00[static_cast<std::size_t>(j)] += m * m * first * first;
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
