// Twin of temporal/bases/coefficients: normal equations by Gauss-Jordan elimination, and
// interpolation written out.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "temporal/bases/coefficients.h"

namespace eigenlight::reference {

/// Weighted sums over the 3 x 3 tiles around `index`.
inline TileSums window(std::span<const TileSums> sums, const TileGrid& grid, int index) {
  TileSums total;
  const int column = index % grid.columns(), row = index / grid.columns();
  for (int i = 0; i < grid.count(); ++i) {
    const int dx = std::abs(i % grid.columns() - column), dy = std::abs(i / grid.columns() - row);
    if (dx > 1 || dy > 1) continue;
    const double w = (2.0 - dx) * (2.0 - dy) / 4.0;
    const TileSums& part = sums[static_cast<std::size_t>(i)];
    for (std::size_t g = 0; g < total.gram.size(); ++g) total.gram[g] += w * part.gram[g];
    for (std::size_t k = 0; k < total.scatter_rr.size(); ++k) {
      total.innovation[k] += w * part.innovation[k];
      total.scatter_rr[k] += w * w * part.scatter_rr[k];
      total.scatter_r0[k] += w * w * part.scatter_r0[k];
      total.scatter_00[k] += w * w * part.scatter_00[k];
    }
  }
  return total;
}

/// Inverse of a symmetric positive definite matrix, with pivoting.
inline std::vector<std::vector<double>> inverse(std::vector<std::vector<double>> a) {
  const std::size_t n = a.size();
  for (std::size_t i = 0; i < n; ++i) {
    a[i].resize(2 * n, 0.0);
    a[i][n + i] = 1.0;
  }
  for (std::size_t col = 0; col < n; ++col) {
    std::size_t pivot = col;
    for (std::size_t i = col; i < n; ++i) {
      if (std::abs(a[i][col]) > std::abs(a[pivot][col])) pivot = i;
    }
    std::swap(a[col], a[pivot]);
    const double scale = 1.0 / a[col][col];
    for (double& value : a[col]) value *= scale;
    for (std::size_t i = 0; i < n; ++i) {
      const double factor = a[i][col];
      if (i == col || factor == 0.0) continue;
      for (std::size_t j = 0; j < 2 * n; ++j) a[i][j] -= factor * a[col][j];
    }
  }
  for (auto& row : a) row.erase(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(n));
  return a;
}

inline double gram(const TileSums& total, std::size_t i, std::size_t j) {
  const int low = static_cast<int>(std::min(i, j)), high = static_cast<int>(std::max(i, j));
  return total.gram[static_cast<std::size_t>(packed(low, high))];
}

/// Variance of <V_i, u - V_0> about the gain 1 + delta.
inline double innovation_variance(const TileSums& total, std::size_t i, double delta) {
  const double pixels = total.gram[0] * total.gram[0] / total.scatter_00[0];
  if (pixels <= 3.0) return total.scatter_rr[i];
  const double about =
      total.scatter_rr[i] - 2.0 * delta * total.scatter_r0[i] + delta * delta * total.scatter_00[i];
  return std::max(about, 0.0) * pixels / (pixels - 3.0);
}

/// How far deltas are shrunk: `expected` are the K mean squares of the tile, or none.
struct Shrinkage {
  ShrinkOptions options;
  std::span<const double> expected;
};

/// Share of a delta of the given variance that is kept; `expected` is its mean square, or 0.
inline double kept_share(const ShrinkOptions& options, double delta, double variance,
                         double expected) {
  if (delta == 0.0) return 0.0;
  const double kept = std::max(0.0, 1.0 - options.noise * variance / (delta * delta));
  return expected > 0.0 ? std::max(kept, expected / (expected + variance)) : kept;
}

/// The K delta_k of one window; 0 for bases without energy. A ridge of 1e-6 of its energy on each
/// basis but the first keeps nearly parallel ones apart.
inline std::vector<double> coefficients(const TileSums& total, const Shrinkage& shrinkage,
                                        int bases) {
  std::vector<double> delta(static_cast<std::size_t>(bases), 0.0);
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < delta.size(); ++k) {
    if (gram(total, k, k) > 1e-10 * total.gram[0]) used.push_back(k);
  }
  if (!(total.gram[0] > 0.0)) return delta;
  const std::size_t rank = used.size();
  std::vector<std::vector<double>> matrix(rank, std::vector<double>(rank));
  for (std::size_t a = 0; a < rank; ++a) {
    for (std::size_t b = 0; b < rank; ++b) matrix[a][b] = gram(total, used[a], used[b]);
    if (a > 0) matrix[a][a] *= 1.0 + 1e-6;
  }
  const auto inverted = inverse(matrix);
  std::vector<double> fitted(rank, 0.0);
  for (std::size_t a = 0; a < rank; ++a) {
    for (std::size_t b = 0; b < rank; ++b) fitted[a] += inverted[a][b] * total.innovation[used[b]];
  }
  for (std::size_t a = 0; a < rank; ++a) {
    double variance = 0.0;
    for (std::size_t b = 0; b < rank; ++b) {
      variance += inverted[a][b] * inverted[a][b] * innovation_variance(total, used[b], fitted[0]);
    }
    const std::size_t k = used[a];
    const double expected = shrinkage.expected.empty() ? 0.0 : shrinkage.expected[k];
    delta[k] = fitted[a] * kept_share(shrinkage.options, fitted[a], variance, expected);
  }
  delta[0] = std::max(delta[0], -1.0);
  return delta;
}

/// value(i) of the tiles of a grid at a pixel: bilinear between tile centers, constant beyond the
/// outermost.
template <typename Value>
double between_tiles(const TileGrid& grid, int x, int y, const Value& value) {
  const auto axis = [](int at, int tiles) {
    return std::clamp((at + 0.5) / kCoefficientTile - 0.5, 0.0, tiles - 1.0);
  };
  const double tx = axis(x, grid.columns()), ty = axis(y, grid.rows());
  double sum = 0.0;
  for (int i = 0; i < grid.count(); ++i) {
    const double wx = std::max(0.0, 1.0 - std::abs(tx - i % grid.columns()));
    const double wy = std::max(0.0, 1.0 - std::abs(ty - i / grid.columns()));
    if (wx * wy > 0.0) sum += wx * wy * static_cast<double>(value(i));
  }
  return sum;
}

/// c_k at a pixel.
template <typename Field>
double coefficient_at(const Field& field, int x, int y, int k) {
  const auto offset = [&](int i) { return field.tile(i)[static_cast<std::size_t>(k)]; };
  return (k == 0 ? 1.0 : 0.0) + between_tiles(field.grid(), x, y, offset);
}

}  // namespace eigenlight::reference
