// PCA of the light at points that are not visible in every frame.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "temporal/baselines/point_tracks.h"

namespace eigenlight {

struct TrackPcaOptions {
  int bases = 8;             ///< [1, 8] N
  int frames_per_basis = 4;  ///< [1, 64]; a point visible in n frames gets at most n / this bases
  int sweeps = 4;            ///< [0, 100] of least squares, where points are missing in frames

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// I(x, t) ~ sum over i of w_i(t) B_i(x), i = 1 .. N (Meyer and Anderson 2006, as Chen 2012, Eq. 1,
/// has it; no mean is subtracted). The weights are the leading eigenvectors of the Gram matrix of
/// the frames, G(s, t) = mean over points x and channels of I(x, s) I(x, t), the bases least
/// squares: with every point in every frame that is the PCA of the sequence, by way of its T x T
/// Gram matrix instead of the huge covariance matrix of its points.
///
/// A point that a frame does not show, or shows without usable light, is left out of all pairs with
/// that frame. Weights and bases are then fitted in turn by least squares to the light that exists;
/// a complete sequence needs no such sweep. Bases are ordered by their energy. Points of few frames
/// have only the first ones, at least one. All sums are in double, in an order that does not depend
/// on threads.
class TrackPca {
 public:
  TrackPca(const PointTracks& tracks, const TrackPcaOptions& options);

  [[nodiscard]] int bases() const { return static_cast<int>(weights_.cols()); }
  /// w_i(t): frames x bases, orthonormal columns.
  [[nodiscard]] const Eigen::MatrixXd& weights() const { return weights_; }
  /// Frames with usable light of a track.
  [[nodiscard]] int seen(std::uint32_t track) const { return seen_[track]; }
  /// Bases that a track has; 0 without usable light.
  [[nodiscard]] int bases_of(std::uint32_t track) const;
  /// sum over i of w_i(t) B_i(x).
  [[nodiscard]] glm::vec3 light(std::uint32_t track, int t) const;

 private:
  void find_weights(const PointTracks& tracks);
  void sweep(const PointTracks& tracks);
  void find_bases(const PointTracks& tracks);

  TrackPcaOptions options_;
  bool is_full_ = true;  // no point is missing in any frame
  Eigen::MatrixXd weights_;
  std::vector<int> seen_;
  std::vector<glm::vec3> values_;  // B: [track][basis]
};

}  // namespace eigenlight
