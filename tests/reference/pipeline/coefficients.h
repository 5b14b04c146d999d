// Coefficients and what tiles remember of them, in double.
#pragma once

#include "temporal/bases/coefficients.h"
#include "temporal/bases/small_matrix.h"
#include "tests/reference/pipeline/image.h"

namespace eigenlight::twin {

/// One number a tile, bilinear between tile centers and constant beyond the outermost.
struct TileValues {
  explicit TileValues(Extent extent)
      : grid(extent, kCoefficientTile, kCoefficientTile),
        values(static_cast<std::size_t>(grid.count()), 0.0) {}
  [[nodiscard]] double& operator[](int tile) { return values[static_cast<std::size_t>(tile)]; }
  [[nodiscard]] double at(int x, int y) const {
    const auto axis = [](int p, int tiles) {
      return std::clamp((p + 0.5) / kCoefficientTile - 0.5, 0.0, tiles - 1.0);
    };
    const double tx = axis(x, grid.columns()), ty = axis(y, grid.rows());
    double sum = 0.0;
    for (int i = 0; i < grid.count(); ++i) {
      const double wx = std::max(0.0, 1.0 - std::abs(tx - i % grid.columns()));
      const double wy = std::max(0.0, 1.0 - std::abs(ty - i / grid.columns()));
      sum += wx * wy * values[static_cast<std::size_t>(i)];
    }
    return sum;
  }

  TileGrid grid;
  std::vector<double> values;
};

/// Entry k of a vector a tile.
using TileVectors = std::vector<TileValues>;

/// Sums over a tile or a window of tiles.
struct Sums {
  explicit Sums(int bases)
      : gram(SmallMatrix::Zero(bases, bases)),
        innovation(SmallVector::Zero(bases)),
        scatter_rr(innovation),
        scatter_r0(innovation),
        scatter_00(innovation) {}
  SmallMatrix gram;
  SmallVector innovation, scatter_rr, scatter_r0, scatter_00;
};

struct SumScene {
  const Bases& bases;
  const FrameInput& frame;
  const Image& variance;
  int active;
};

/// A pixel's weight, and how far beyond the bound on outliers it is.
struct SumWeight {
  double weight = 0.0, excess = 0.0;
};

inline SumWeight sum_weight(const SumScene& in, int x, int y) {
  const double n = in.bases.age(x, y), steady = luminance(in.bases[0], x, y);
  const double expected = in.variance(x, y) + 0.01 * steady * steady;
  if (!(n > 0.0) || !(expected > 1e-30)) return {};
  constexpr std::array<double, 3> kRec709{0.2126, 0.7152, 0.0722};
  double off = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double u = static_cast<double>(in.frame.lights[0].radiance[c](x, y));
    if (!(std::abs(u) <= static_cast<double>(kLargestLight))) return {};
    off += kRec709[c] * (u - in.bases[0][c](x, y));
  }
  const double weight = n / (n + 1.0) / expected;
  return {weight, weight * off * off / (kOutlier * kOutlier)};
}

inline void add_pixel(const SumScene& in, int x, int y, double weight, Sums& sums) {
  for (int j = 0; j < in.active; ++j) {
    double along = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double u = static_cast<double>(in.frame.lights[0].radiance[c](x, y));
      along += weight * in.bases[j][c](x, y) * (u - in.bases[0][c](x, y));
    }
    const double first = weight * in.bases.dot(j, 0, x, y);
    sums.innovation[j] += along;
    sums.scatter_rr[j] += along * along;
    sums.scatter_r0[j] += along * first;
    sums.scatter_00[j] += first * first;
    for (int i = 0; i < in.active; ++i) sums.gram(i, j) += weight * in.bases.dot(i, j, x, y);
  }
}

inline Sums tile_sums(const SumScene& in, const Rect& tile) {
  int used = 0, outliers = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const SumWeight pixel = sum_weight(in, x, y);
      used += pixel.weight > 0.0 ? 1 : 0;
      outliers += pixel.excess > 1.0 ? 1 : 0;
    }
  }
  Sums sums(in.active);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const SumWeight pixel = sum_weight(in, x, y);
      const double held = 8 * outliers <= used ? std::max(pixel.excess, 1.0) : 1.0;
      if (pixel.weight > 0.0) add_pixel(in, x, y, pixel.weight / held, sums);
    }
  }
  return sums;
}

inline Sums window_sums(const std::vector<Sums>& tiles, const TileGrid& grid, int index) {
  Sums total(static_cast<int>(tiles[0].innovation.size()));
  for (int i = 0; i < grid.count(); ++i) {
    const int dx = std::abs(i % grid.columns() - index % grid.columns());
    const int dy = std::abs(i / grid.columns() - index / grid.columns());
    if (dx > 1 || dy > 1) continue;
    const double w = (2 - dx) * (2 - dy) / 4.0;
    const Sums& part = tiles[static_cast<std::size_t>(i)];
    total.gram += w * part.gram;
    total.innovation += w * part.innovation;
    total.scatter_rr += w * w * part.scatter_rr;
    total.scatter_r0 += w * w * part.scatter_r0;
    total.scatter_00 += w * w * part.scatter_00;
  }
  return total;
}

/// delta of the bases in `sums`, shrunk; `expected` holds their mean squares.
inline SmallVector solve(const Sums& sums, const SmallVector& expected, double noise) {
  const auto bases = static_cast<int>(sums.innovation.size());
  SmallVector delta = SmallVector::Zero(bases);
  const double first = sums.gram(0, 0);
  if (!(first > 0.0)) return delta;
  std::vector<int> used;
  for (int k = 0; k < bases; ++k) {
    if (sums.gram(k, k) > 1e-10 * first) used.push_back(k);
  }
  SmallMatrix gram = sums.gram(used, used);
  const auto rank = static_cast<int>(used.size());
  for (int a = 1; a < rank; ++a) gram(a, a) *= 1.0 + 1e-6;
  const SmallMatrix inverse = gram.ldlt().solve(SmallMatrix::Identity(rank, rank));
  const SmallVector found = inverse * SmallVector(sums.innovation(used));
  const double pixels = first * first / sums.scatter_00[0], gain = found[0];
  for (int a = 0; a < rank; ++a) {
    double variance = 0.0;
    for (int b = 0; b < rank; ++b) {
      const int k = used[static_cast<std::size_t>(b)];
      const double about =
          sums.scatter_rr[k] - 2.0 * gain * sums.scatter_r0[k] + gain * gain * sums.scatter_00[k];
      const double scatter =
          pixels > 3.0 ? std::max(about, 0.0) * pixels / (pixels - 3.0) : sums.scatter_rr[k];
      variance += inverse(a, b) * inverse(a, b) * scatter;
    }
    const int k = used[static_cast<std::size_t>(a)];
    const double square = found[a] * found[a], m = expected[k];
    double kept = square > 0.0 ? std::max(0.0, 1.0 - noise * variance / square) : 0.0;
    if (m > 0.0 && square > 0.0) kept = std::max(kept, m / (m + variance));
    delta[k] = kept * found[a];
  }
  delta[0] = std::max(delta[0], -1.0);
  return delta;
}

}  // namespace eigenlight::twin
