// Bases over thousands of frames: they must stay linearly independent.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "sequences/stress/eigen_state.h"
#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"
#include "temporal/baselines/basis_history.h"
#include "temporal/baselines/chen2012_pca.h"
#include "temporal/bases/small_matrix.h"
#include "temporal/bases/tile_sums.h"

namespace eigenlight {
namespace {

// One coefficient tile.
constexpr Extent kExtent{kCoefficientTile, kCoefficientTile};

// Two lamps sweep over the plane at different speeds: light of rank 3 or more.
AnalyticOptions sweeping(int frames) {
  AnalyticOptions options{.extent = kExtent, .frames = frames};
  options.light = [](glm::vec2 at, int frame) {
    const float f = static_cast<float>(frame);
    return 1.0f + 0.7f * std::sin(0.2f * at.x + 0.13f * f) * std::sin(0.071f * f) +
           0.2f * std::cos(0.3f * at.y - 0.09f * f);
  };
  return options;
}

// Largest |cosine| between two bases that are not 0.
double largest_cosine(const BasisField& field) {
  const int bases = field.bases();
  SmallMatrix gram = SmallMatrix::Zero(bases, bases);
  for (int y = 0; y < field.extent().height; ++y) {
    for (int x = 0; x < field.extent().width; ++x) {
      for (int c = 0; c < 3; ++c) {
        SmallVector v(bases);
        for (int k = 0; k < bases; ++k) v[k] = static_cast<double>(field.value(x, y, c, k));
        gram += v * v.transpose();
      }
    }
  }
  double largest = 0.0;
  for (int i = 0; i < bases; ++i) {
    for (int j = 0; j < i; ++j) {
      const double length = std::sqrt(gram(i, i) * gram(j, j));
      if (length > 0.0) largest = std::max(largest, std::abs(gram(i, j)) / length);
    }
  }
  return largest;
}

// Each frame works with the orthogonalized bases of the previous frame; the camera is static, so
// there is no warp between.
StressFinding check_orthogonality(StressLog& log) {
  constexpr int kBases = 5;
  StressRun run(log, sweeping(10'000), "chen2012", kBases);
  ImagePca pca(kExtent, kBases);
  while (run.step()) {
    StateWriter saved;
    run.denoiser().save(saved);
    StateReader in({saved.bytes().data(), saved.bytes().size()});
    std::uint32_t version = 0;
    int number = 0;
    in.value("chen2012", version);
    in.value("number", number);
    BasisHistory history(kExtent, kBases);
    history.load(in);
    pca.orthogonalize(history.bases());
    log.note(largest_cosine(history.bases()), fmt::format("frame {}", run.frame().index));
  }
  return worst_of(log, 1e-5);
}

// Condition of the matrix of solve_coefficients(), with bases of unit length; 0 for one basis.
double condition(const EigenState& state, const Frame& frame) {
  TileSums sums;
  const SumInputs in{state.field, frame.lights[0].radiance, state.variance, state.memory.active()};
  const Rect all{0, 0, kExtent.width, kExtent.height};
  accumulate_tile(in, all, sums);
  admit_outliers(in, all, sums);
  const auto energy = [&](int k) { return sums.gram[static_cast<std::size_t>(packed(k, k))]; };
  std::vector<int> used;
  for (int k = 0; k < state.memory.active(); ++k) {
    if (energy(k) > 1e-10 * energy(0)) used.push_back(k);
  }
  const auto rank = static_cast<int>(used.size());
  if (rank < 2) return 0.0;
  SmallMatrix gram(rank, rank);
  for (int a = 0; a < rank; ++a) {
    for (int b = 0; b <= a; ++b) {
      const int i = used[static_cast<std::size_t>(b)], j = used[static_cast<std::size_t>(a)];
      gram(a, b) = gram(b, a) =
          sums.gram[static_cast<std::size_t>(packed(i, j))] / std::sqrt(energy(i) * energy(j));
    }
    if (a > 0) gram(a, a) *= 1.0 + 1e-6;
  }
  const Eigen::SelfAdjointEigenSolver<SmallMatrix> solver(gram, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[rank - 1] / solver.eigenvalues()[0];
}

// Sums are exact to 1e-7 (float along a row), so coefficients to 1e-7 times the condition: at 1e4
// to a tenth of a percent.
StressFinding check_condition(StressLog& log) {
  constexpr int kBases = 5;
  StressRun run(log, sweeping(10'000), "eigenlight", kBases);
  EigenState state(kExtent, kBases);
  double cosine = 0.0, rank = 0.0;
  while (run.step()) {
    state.take(run.denoiser());
    log.note(condition(state, run.frame()), fmt::format("frame {}", run.frame().index));
    cosine = std::max(cosine, largest_cosine(state.field));
    rank += run.report().mean_rank / 10'000;
  }
  StressFinding finding = worst_of(log, 1e4);
  finding.note = fmt::format("largest cosine {:.3f}, mean rank {:.2f}", cosine, rank);
  return finding;
}

}  // namespace

std::vector<StressCase> basis_cases() {
  return {
      {"bases.orthogonality",
       "chen2012, 10,000 frames of moving light: largest |cosine| of two bases", true,
       check_orthogonality},
      {"bases.condition", "eigenlight, 10,000 frames of moving light: condition of the Gram matrix",
       true, check_condition}};
}

}  // namespace eigenlight
