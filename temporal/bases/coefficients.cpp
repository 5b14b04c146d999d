#include "temporal/bases/coefficients.h"

#include <algorithm>
#include <cmath>

#include "temporal/bases/small_matrix.h"

namespace eigenlight {
namespace {

TileSums window_sums(std::span<const TileSums> sums, const TileGrid& grid, int index) {
  TileSums total;
  const int column = index % grid.columns(), row = index / grid.columns();
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = column + dx, y = row + dy;
      if (x < 0 || y < 0 || x >= grid.columns() || y >= grid.rows()) continue;
      const double weight = (2 - std::abs(dx)) * (2 - std::abs(dy)) / 4.0;
      TileSums part = sums[static_cast<std::size_t>(y * grid.columns() + x)];
      for (double& g : part.gram) g *= weight;
      for (double& d : part.innovation) d *= weight;
      for (auto* squares : {&part.scatter_rr, &part.scatter_r0, &part.scatter_00}) {
        for (double& s : *squares) s *= weight * weight;
      }
      part.pixels *= weight;
      total += part;
    }
  }
  return total;
}

// The bases of a window that have energy.
struct Used {
  std::array<int, kMaxBases> basis{};
  int count = 0;
};

Used find_used(const TileSums& sums, int bases) {
  Used used;
  for (int k = 0; k < bases; ++k) {
    // Below 1e-10 of the energy of the first basis, a basis is rounding error of the warp.
    if (sums.gram[static_cast<std::size_t>(packed(k, k))] > 1e-10 * sums.gram[0]) {
      used.basis[static_cast<std::size_t>(used.count++)] = k;
    }
  }
  return used;
}

SmallMatrix regular_gram(const TileSums& sums, const Used& used) {
  SmallMatrix gram(used.count, used.count);
  for (int a = 0; a < used.count; ++a) {
    const int j = used.basis[static_cast<std::size_t>(a)];
    for (int b = 0; b <= a; ++b) {
      const int i = used.basis[static_cast<std::size_t>(b)];
      gram(a, b) = gram(b, a) = sums.gram[static_cast<std::size_t>(packed(i, j))];
    }
    // A ridge of 1e-6 of its energy bounds the condition of nearly parallel bases by 1e6. The first
    // basis has none: a light that falls to 1e-6 would be estimated as 2e-6.
    if (a > 0) gram(a, a) *= 1.0 + 1e-6;
  }
  return gram;
}

// delta and its variance for the bases that have energy; zeros for the others.
struct Solution {
  SmallVector delta, variance;
};

Solution solve(const TileSums& sums, int bases) {
  Solution out{SmallVector::Zero(bases), SmallVector::Zero(bases)};
  const Used used = find_used(sums, bases);
  const int rank = used.count;
  if (rank == 0 || !(sums.gram[0] > 0.0)) return out;

  const auto basis = [&](int a) { return used.basis[static_cast<std::size_t>(a)]; };
  SmallVector right(rank), scatter(rank);
  for (int a = 0; a < rank; ++a) right[a] = sums.innovation[static_cast<std::size_t>(basis(a))];
  const SmallMatrix identity = SmallMatrix::Identity(rank, rank);
  const SmallMatrix inverse = regular_gram(sums, used).ldlt().solve(identity);
  const SmallVector delta = inverse * right;
  for (int a = 0; a < rank; ++a) {
    scatter[a] = sums.innovation_variance(static_cast<std::size_t>(basis(a)), delta[0]);
  }
  for (int a = 0; a < rank; ++a) {
    out.delta[basis(a)] = delta[a];
    for (int b = 0; b < rank; ++b) {
      out.variance[basis(a)] += inverse(a, b) * inverse(a, b) * scatter[b];
    }
  }
  return out;
}

}  // namespace

void ShrinkOptions::validate() const {
  EL_CHECK(noise >= 0.0 && noise <= 100.0, "noise {}: expected [0, 100] variances", noise);
}

CoefficientField::CoefficientField(Extent extent, int bases)
    : grid_(extent, kCoefficientTile, kCoefficientTile),
      bases_(bases),
      used_(bases),
      values_(static_cast<std::size_t>(grid_.count() * kMaxBases), 0.0f) {}

void solve_coefficients(std::span<const TileSums> sums, std::span<const double> expected,
                        const ShrinkOptions& options, CoefficientField& field) {
  const TileGrid& grid = field.grid();
  const int bases = field.bases();
  EL_CHECK(sums.size() == static_cast<std::size_t>(grid.count()), "{} tile sums for {} tiles",
           sums.size(), grid.count());
  EL_CHECK(expected.empty() || expected.size() == sums.size() * static_cast<std::size_t>(bases),
           "{} expected squares for {} tiles of {} bases", expected.size(), sums.size(), bases);
  parallel_for(grid.count(), [&](int index) {
    const Solution s = solve(window_sums(sums, grid, index), bases);
    const auto out = field.tile(index);
    for (int k = 0; k < bases; ++k) {
      const double square = s.delta[k] * s.delta[k];
      double kept =
          square > 0.0 ? std::max(0.0, 1.0 - options.noise * s.variance[k] / square) : 0.0;
      if (!expected.empty() && square > 0.0) {
        const double m = expected[static_cast<std::size_t>(index * bases + k)];
        if (m > 0.0) kept = std::max(kept, m / (m + s.variance[k]));  // 0 / 0 in the dark
      }
      const double delta = kept * s.delta[k];
      out[static_cast<std::size_t>(k)] = static_cast<float>(k == 0 ? std::max(delta, -1.0) : delta);
    }
  });
}

}  // namespace eigenlight
