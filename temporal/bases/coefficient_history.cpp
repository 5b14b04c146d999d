#include "temporal/bases/coefficient_history.h"

#include <algorithm>
#include <stdexcept>

namespace eigenlight {
namespace {

// Share of the statistics that each frame keeps: coefficients are remembered as long as light.
constexpr double kLambda = 1.0 - 1.0 / static_cast<double>(kLongestAge);

// Weight of a new basis in frames. It is a mean over some hundred pixels, but has lost detail.
constexpr double kBirthInformation = 8.0;

// Frames between births: coefficients of the last new basis need time to settle.
constexpr int kBirthInterval = 4;

// Use in frames below which a basis is retired.
constexpr double kForgotten = 0.05;

int checked(int bases) {
  EL_CHECK(bases >= 1 && bases <= kMaxBases, "bases {}: expected 1 to {}", bases, kMaxBases);
  return bases;
}

}  // namespace

CoefficientHistory::CoefficientHistory(Extent extent, int bases)
    : bases_(checked(bases)),
      tiles_(TileGrid(extent, kCoefficientTile, kCoefficientTile).count()),
      in_use_(static_cast<std::size_t>(bases)),
      information_(static_cast<std::size_t>(tiles_ * bases * bases)),
      expected_(static_cast<std::size_t>(tiles_ * bases)) {
  reset();
}

void CoefficientHistory::reset() {
  since_birth_ = 0;
  std::fill(in_use_.begin(), in_use_.end(), std::uint8_t{0});
  in_use_[0] = 1;
  std::fill(information_.begin(), information_.end(), 0.0);
  std::fill(expected_.begin(), expected_.end(), 0.0);
}

int CoefficientHistory::active() const {
  const auto last = std::find(in_use_.rbegin(), in_use_.rend(), std::uint8_t{1});
  return static_cast<int>(in_use_.rend() - last);
}

SmallMatrix CoefficientHistory::normalized(int tile) const {
  const double* values = information_.data() + static_cast<std::size_t>(tile * bases_ * bases_);
  const SmallMatrix r = Eigen::Map<const SmallMatrix>(values, bases_, bases_);
  return r / r(0, 0);
}

void CoefficientHistory::learn(const CoefficientField& coefficients,
                               CoefficientField& learning_rates) {
  since_birth_ = std::min(since_birth_ + 1, kBirthInterval);  // must not overflow in long runs
  const int rank = active();
  parallel_for(tiles_, [&](int tile) {
    const auto delta = coefficients.tile(tile);
    SmallVector c = SmallVector::Zero(bases_);
    c[0] = 1.0;
    for (int k = 1; k < rank; ++k) c[k] = static_cast<double>(delta[static_cast<std::size_t>(k)]);

    double* values = information_.data() + static_cast<std::size_t>(tile * bases_ * bases_);
    Eigen::Map<SmallMatrix> r(values, bases_, bases_);
    r = kLambda * r + c * c.transpose();

    // Solve over the slots in use. A ridge of 1e-3 of a frame's worth bounds what an idle basis
    // learns. The first is never idle: R_00 >= 1, and a ridge there would take 0.1 % of new light.
    SmallMatrix m = normalized(tile).topLeftCorner(rank, rank);
    for (int k = 0; k < rank; ++k) {
      if (k > 0) m(k, k) += in_use_[static_cast<std::size_t>(k)] ? 1e-3 / r(0, 0) : 1.0;
      expected_[static_cast<std::size_t>(tile * bases_ + k)] =
          k > 0 && in_use_[static_cast<std::size_t>(k)] ? r(k, k) / r(0, 0) : 0.0;
    }
    const SmallVector q = m.ldlt().solve(SmallVector(c.head(rank)));
    const auto out = learning_rates.tile(tile);
    std::fill(out.begin(), out.end(), 0.0f);
    for (int k = 0; k < rank; ++k) {
      out[static_cast<std::size_t>(k)] = static_cast<float>(q[k] - (k == 0 ? 1.0 : 0.0));
    }
  });
}

int CoefficientHistory::free_slot() const {
  if (since_birth_ < kBirthInterval) return 0;
  const auto slot = std::find(in_use_.begin(), in_use_.end(), std::uint8_t{0});
  return slot == in_use_.end() ? 0 : static_cast<int>(slot - in_use_.begin());
}

void CoefficientHistory::born(int k) {
  since_birth_ = 0;
  in_use_[static_cast<std::size_t>(k)] = 1;
  for (int tile = 0; tile < tiles_; ++tile) {
    double* values = information_.data() + static_cast<std::size_t>(tile * bases_ * bases_);
    Eigen::Map<SmallMatrix> r(values, bases_, bases_);
    r.row(k).setZero();
    r.col(k).setZero();
    r(k, k) = kBirthInformation;
  }
}

std::vector<int> CoefficientHistory::retire() {
  std::vector<int> retired;
  for (int k = 1; k < bases_; ++k) {
    if (!in_use_[static_cast<std::size_t>(k)]) continue;
    double most = 0.0;
    for (int tile = 0; tile < tiles_; ++tile) {
      most =
          std::max(most, information_[static_cast<std::size_t>((tile * bases_ + k) * bases_ + k)]);
    }
    if (most >= kForgotten) continue;
    in_use_[static_cast<std::size_t>(k)] = 0;
    retired.push_back(k);
  }
  return retired;
}

void CoefficientHistory::save(StateWriter& out) const {
  out.value("frames since birth", since_birth_);
  for (const std::uint8_t used : in_use_) out.value("slot in use", used);
  for (const double value : information_) out.value("information", value);
  for (const double value : expected_) out.value("expected", value);
}

void CoefficientHistory::load(StateReader& in) {
  in.value("frames since birth", since_birth_);
  since_birth_ = std::clamp(since_birth_, 0, kBirthInterval);
  bool valid = true;
  for (std::uint8_t& used : in_use_) {
    in.value("slot in use", used);
    valid = valid && used <= 1;
  }
  if (!valid || in_use_[0] != 1) throw std::runtime_error("state of 'slots': none that can be");
  for (double& value : information_) in.value("information", value);
  for (double& value : expected_) in.value("expected", value);
}

}  // namespace eigenlight
