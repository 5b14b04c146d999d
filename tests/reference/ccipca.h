// Candid covariance-free incremental PCA on plain vectors, in double: Weng, Zhang and Hwang 2003,
// and Chen 2012, Algorithm 1.
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace eigenlight::reference {

class Ccipca {
 public:
  Ccipca(Eigen::Index size, int bases)
      : bases_(static_cast<std::size_t>(bases), Eigen::VectorXd::Zero(size)) {}

  /// Takes in u with a weight for each of its elements.
  void update(const Eigen::VectorXd& u, const Eigen::VectorXd& weight) {
    ++frames_;
    Eigen::VectorXd rest = u;
    for (std::size_t i = 0; i < std::min(bases_.size(), frames_); ++i) {
      Eigen::VectorXd& v = bases_[i];
      if (i + 1 == frames_) {
        v = rest;
      } else {
        const double dot = rest.dot(v) / v.norm();
        v = v - weight.cwiseProduct(v) + dot * weight.cwiseProduct(rest);
      }
      rest -= rest.dot(v.normalized()) * v.normalized();
    }
  }

  [[nodiscard]] Eigen::VectorXd reconstruct(const Eigen::VectorXd& u) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(u.size());
    for (const auto& v : bases_) sum += u.dot(v.normalized()) * v.normalized();
    return sum;
  }

  [[nodiscard]] const Eigen::VectorXd& basis(int i) const {
    return bases_[static_cast<std::size_t>(i)];
  }

 private:
  std::vector<Eigen::VectorXd> bases_;
  std::size_t frames_ = 0;
};

}  // namespace eigenlight::reference
