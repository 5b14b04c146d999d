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

/// The K delta_k of one window. All bases must have energy and be independent.
inline std::vector<double> coefficients(const TileSums& total, const Shrinkage& shrinkage,
                                        int bases) {
  const auto n = static_cast<std::size_t>(bases);
  std::vector<std::vector<double>> gram(n, std::vector<double>(n));
  for (int i = 0; i < bases; ++i) {
    for (int j = 0; j < bases; ++j) {
      gram[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          total.gram[static_cast<std::size_t>(packed(std::min(i, j), std::max(i, j)))];
    }
  }
  const auto inverted = inverse(gram);
  std::vector<double> delta(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < n; ++i) delta[k] += inverted[k][i] * total.innovation[i];
  }
  const double fitted = delta[0];
  for (std::size_t k = 0; k < n; ++k) {
    double variance = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      variance += inverted[k][i] * inverted[k][i] * innovation_variance(total, i, fitted);
    }
    if (delta[k] == 0.0) continue;
    double kept = std::max(0.0, 1.0 - shrinkage.options.noise * variance / (delta[k] * delta[k]));
    if (!shrinkage.expected.empty()) {
      kept = std::max(kept, shrinkage.expected[k] / (shrinkage.expected[k] + variance));
    }
    delta[k] *= kept;
    if (k == 0) delta[k] = std::max(delta[k], -1.0);
  }
  return delta;
}

/// c_k at a pixel: bilinear between tile centers, constant beyond the outermost.
inline double coefficient_at(const CoefficientField& field, int x, int y, int k) {
  const TileGrid& grid = field.grid();
  const auto axis = [](int at, int tiles) {
    const double t = (at + 0.5) / kCoefficientTile - 0.5;
    return std::clamp(t, 0.0, static_cast<double>(tiles - 1));
  };
  const double tx = axis(x, grid.columns()), ty = axis(y, grid.rows());
  double sum = k == 0 ? 1.0 : 0.0;
  for (int i = 0; i < grid.count(); ++i) {
    const double wx = std::max(0.0, 1.0 - std::abs(tx - i % grid.columns()));
    const double wy = std::max(0.0, 1.0 - std::abs(ty - i / grid.columns()));
    sum += wx * wy * static_cast<double>(field.tile(i)[static_cast<std::size_t>(k)]);
  }
  return sum;
}

}  // namespace eigenlight::reference
