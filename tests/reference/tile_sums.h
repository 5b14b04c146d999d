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

/// `In` is SumInputs, or the same in double.
template <typename In>
SumPixel sum_pixel(const In& in, int x, int y) {
  const auto& v = in.bases;
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
  const double expected = in.variance(x, y) + 0.01 * steady * steady;
  pixel.weight = expected > 1e-30 ? n / (n + 1.0) / expected : 0.0;
  return pixel;
}

/// How far beyond the bound a pixel is: its weight is to be divided by this where it exceeds 1.
inline double sum_excess(const SumPixel& pixel) {
  const double off = luminance(pixel.r[0], pixel.r[1], pixel.r[2]) / kOutlier;
  return pixel.weight * off * off;
}

/// The pixels of a tile, row by row, few outliers held back.
template <typename In>
std::vector<SumPixel> sum_pixels(const In& in, const Rect& tile) {
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

/// Adds a pixel of weight m and residual r.
template <typename In>
void add_pixel(const In& in, int x, int y, const SumPixel& pixel, TileSums& sums) {
  const auto dot = [&](int i, int j) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
      sum += static_cast<double>(in.bases.value(x, y, c, i)) *
             static_cast<double>(in.bases.value(x, y, c, j));
    }
    return sum;
  };
  const double m = pixel.weight;
  sums.pixels += 1.0;
  for (int j = 0; j < std::min(in.bases.bases(), in.active); ++j) {
    double along = 0.0;
    for (int c = 0; c < 3; ++c) along += in.bases.value(x, y, c, j) * pixel.r[c];
    const double first = dot(j, 0);
    const auto at = static_cast<std::size_t>(j);
    sums.innovation[at] += m * along;
    sums.scatter_rr[at] += m * m * along * along;
    sums.scatter_r0[at] += m * m * along * first;
    sums.scatter_00[at] += m * m * first * first;
    for (int i = 0; i <= j; ++i) sums.gram[static_cast<std::size_t>(packed(i, j))] += m * dot(i, j);
  }
}

template <typename In>
TileSums tile_sums(const In& in, const Rect& tile) {
  TileSums sums;
  const std::vector<SumPixel> pixels = sum_pixels(in, tile);
  auto next = pixels.begin();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++next) {
      if (next->weight > 0.0) add_pixel(in, x, y, *next, sums);
    }
  }
  return sums;
}

}  // namespace eigenlight::reference
