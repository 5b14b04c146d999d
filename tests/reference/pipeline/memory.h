// Twin of CoefficientHistory in double. Its caller decides which slots are born and retired.
#pragma once

#include <vector>

#include "temporal/bases/small_matrix.h"
#include "tests/reference/image.h"

namespace eigenlight::twin {

class Memory {
 public:
  Memory(Extent extent, int bases)
      : bases_(bases),
        information_(static_cast<std::size_t>(
            TileGrid(extent, kCoefficientTile, kCoefficientTile).count())) {
    reset();
  }

  void reset() {
    in_use_.assign(static_cast<std::size_t>(bases_), false);
    in_use_[0] = true;
    for (auto& r : information_) r = SmallMatrix::Zero(bases_, bases_);
    expected_.assign(information_.size(), SmallVector::Zero(bases_));
  }
  [[nodiscard]] int active() const {
    int last = 0;
    for (int k = 0; k < bases_; ++k) last = in_use_[static_cast<std::size_t>(k)] ? k : last;
    return last + 1;
  }
  /// Mean squares of delta_k.
  [[nodiscard]] std::span<const double> expected(int tile) const {
    return {expected_[static_cast<std::size_t>(tile)].data(), static_cast<std::size_t>(bases_)};
  }

  /// R <- lambda R + c c^T with c = (1, delta_1, ...), and q = (R / R_00 + ridge)^-1 c.
  void learn(const reference::Coefficients& coefficients, reference::Coefficients& learning_rates) {
    const int rank = active();
    for (int tile = 0; tile < static_cast<int>(information_.size()); ++tile) {
      SmallVector c = SmallVector::Zero(bases_);
      c[0] = 1.0;
      for (int k = 1; k < rank; ++k) c[k] = coefficients.tile(tile)[static_cast<std::size_t>(k)];
      SmallMatrix& r = information_[static_cast<std::size_t>(tile)];
      r = (1.0 - 1.0 / 64.0) * r + c * c.transpose();
      SmallMatrix m = r.topLeftCorner(rank, rank) / r(0, 0);
      for (int k = 1; k < rank; ++k) {
        const bool used = in_use_[static_cast<std::size_t>(k)];
        m(k, k) += used ? 1e-3 / r(0, 0) : 1.0;
        expected_[static_cast<std::size_t>(tile)][k] = used ? r(k, k) / r(0, 0) : 0.0;
      }
      const SmallVector q = m.ldlt().solve(SmallVector(c.head(rank)));
      learning_rates.tile(tile).fill(0.0);
      for (int k = 0; k < rank; ++k) {
        learning_rates.tile(tile)[static_cast<std::size_t>(k)] = q[k] - (k == 0 ? 1.0 : 0.0);
      }
    }
  }

  void born(int k) {
    in_use_[static_cast<std::size_t>(k)] = true;
    for (SmallMatrix& r : information_) {
      r.row(k).setZero();
      r.col(k).setZero();
      r(k, k) = 8.0;
    }
  }
  void retire(int k) { in_use_[static_cast<std::size_t>(k)] = false; }

 private:
  int bases_;
  std::vector<bool> in_use_;
  std::vector<SmallMatrix> information_;
  std::vector<SmallVector> expected_;
};

}  // namespace eigenlight::twin
