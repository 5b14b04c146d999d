// Coefficients of the bases in each tile: projection of this frame's light, less its noise.
#pragma once

#include <span>
#include <vector>

#include "frame/tiles.h"
#include "temporal/bases/tile_sums.h"

namespace eigenlight {

/// Side of a coefficient tile in pixels, half a segment. 32 gives less error than 16
/// (docs/experiments/2026-11-prototype.md).
inline constexpr int kCoefficientTile = 32;

struct ShrinkOptions {
  /// [0, 100] noise variances subtracted from each squared coefficient; see solve_coefficients().
  double noise = 4.0;

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Coefficients along a row of one tile: values[k][i] is c_k of its pixel i, with room for the
/// pixels of a whole tile.
struct CoefficientRows {
  alignas(64) float values[kMaxBases][kCoefficientTile];

  const float* operator[](int k) const { return values[k]; }
};

/// Coefficients c_k of every tile, as offsets from the steady light (1, 0, ..., 0), and their
/// smooth interpolation between tile centers.
class CoefficientField {
 public:
  CoefficientField(Extent extent, int bases);

  [[nodiscard]] const TileGrid& grid() const { return grid_; }
  [[nodiscard]] int bases() const { return bases_; }
  /// Coefficients k >= used() are 0 in all tiles.
  [[nodiscard]] int used() const { return used_; }
  void set_used(int used) { used_ = used; }
  [[nodiscard]] std::span<float> tile(int index) {
    return {values_.data() + static_cast<std::size_t>(index * kMaxBases),
            static_cast<std::size_t>(bases_)};
  }
  /// kMaxBases values may be read from its start.
  [[nodiscard]] std::span<const float> tile(int index) const {
    return {values_.data() + static_cast<std::size_t>(index * kMaxBases),
            static_cast<std::size_t>(bases_)};
  }
  /// c_0 to c_(count - 1) (the steady 1 of k = 0 included) along row y0 of the tile column that
  /// starts at x0, bilinear between tile centers and constant beyond the outermost; count <=
  /// bases().
  void rows(const Rect& row, int count, CoefficientRows& out) const;

 private:
  TileGrid grid_;
  int bases_, used_;
  std::vector<float> values_;
};

/// Least squares for u = V_0 + sum_k delta_k V_k over each tile's overlapping window (its 3 x 3
/// neighbors, tent weights (2 - |dx|)(2 - |dy|) / 4): G delta = d, G_ij = <V_i, V_j>,
/// d_i = <V_i, u - V_0>. This is Chen 2012's projection (section 3.3), solved jointly because
/// warped bases are not orthogonal. The bases do not contain this frame yet (leave one out).
///
/// Each delta_k is then shrunk by its own noise, delta_k * max(0, 1 - noise var(delta_k) /
/// delta_k^2) (positive-part James-Stein), with var from TileSums::innovation_variance() about the
/// gain 1 + delta_0. Without shrinkage a steady light flickers by the noise of its gain. With the
/// variance about a gain of 1, a light that goes out leaves 0.2 % of itself behind.
///
/// `expected` holds the mean square m of delta_k over past frames (entry tile * K + k), or is
/// empty. The Wiener factor m / (m + var) replaces the factor above where it is larger: bases that
/// were used in past frames are shrunk less.
///
/// Bases without energy get delta 0. The gain 1 + delta_0 is at least 0. `sums` holds one entry per
/// tile of the field's grid.
void solve_coefficients(std::span<const TileSums> sums, std::span<const double> expected,
                        const ShrinkOptions& options, CoefficientField& field);

}  // namespace eigenlight
