// Statistics of each tile's coefficients over past frames. They set the learning rate of each
// basis.
#pragma once

#include <vector>

#include "frame/state.h"
#include "temporal/bases/coefficients.h"
#include "temporal/bases/small_matrix.h"

namespace eigenlight {

/// Per tile the information matrix R <- lambda R + c c^T over the coefficients c = (1, delta_1,
/// ...) of past frames, lambda = 1 - 1/64 (the memory of the longest age). R_00 counts frames.
///
/// With M = R / R_00 the mean of c c^T, recursive least squares of u on c gives each basis its
/// share of the residual r of a pixel of age n:
///   V_k += q_k r s / (n + h s),   q = M^-1 c,   h = c^T q
/// (subspace tracking by projection approximation, PAST, Yang 1995). For uncorrelated coefficients
/// of mean square M_kk, as in CCIPCA, it is Algorithm 1 of Chen 2012, with step c_k r / M_kk and
/// weight w = 1/n. Unlike there, a step never overshoots: it changes the prediction of the current
/// frame by the fraction h / (n + h) of the residual.
///
/// A slot k >= 1 holds the same basis in all tiles of the image, because coefficients are
/// interpolated between tiles.
class CoefficientHistory {
 public:
  /// Throws std::invalid_argument unless `bases` is in [1, kMaxBases].
  CoefficientHistory(Extent extent, int bases);

  [[nodiscard]] int bases() const { return bases_; }
  [[nodiscard]] bool is_used(int k) const { return in_use_[static_cast<std::size_t>(k)] != 0; }
  /// Bases in use: slots [0, active()) may hold energy.
  [[nodiscard]] int active() const;
  /// Expected delta_k^2, entry tile * K + k: M_kk, and 0 for k = 0 and for free slots.
  [[nodiscard]] std::span<const double> expected() const { return expected_; }

  /// Takes in the frame's coefficients and fills `learning_rates` with q - (1, 0, ...) of each
  /// tile.
  void learn(const CoefficientField& coefficients, CoefficientField& learning_rates);

  /// A free slot k >= 1 for a new basis, or 0 if none is free or the last birth is too recent.
  [[nodiscard]] int free_slot() const;
  /// Basis k was born in this frame with coefficient 1.
  void born(int k);
  /// Frees and returns the slots of bases that no tile has used for long. The caller must clear
  /// them.
  [[nodiscard]] std::vector<int> retire();

  void reset();
  void save(StateWriter& out) const;
  void load(StateReader& in);

 private:
  [[nodiscard]] SmallMatrix normalized(int tile) const;

  int bases_, tiles_;
  int since_birth_ = 0;               // frames, up to the interval between births
  std::vector<std::uint8_t> in_use_;  // per slot
  std::vector<double> information_;   // per tile: K x K
  std::vector<double> expected_;      // per tile: K
};

}  // namespace eigenlight
