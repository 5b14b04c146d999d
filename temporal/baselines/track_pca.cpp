#include "temporal/baselines/track_pca.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace eigenlight {
namespace {

constexpr std::uint32_t kChunk = 2048;  // tracks that one thread handles at a time
constexpr int kMostBases = 8;
// Few frames may not separate all bases. A share of the largest diagonal entry, far below noise.
constexpr double kRidge = 1e-6;

using Eigen::Index;
using Eigen::MatrixXd;
using SmallMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostBases, kMostBases>;
using SmallBases = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMostBases, 3>;

// The light of the tracks [first, first + count), laid out frame by frame.
struct Series {
  std::uint32_t first = 0;
  Index count = 0;
  MatrixXd light;  // frames x 3 count, a track's channels side by side; 0 where not usable
  MatrixXd seen;   // frames x count: 1 or 0
};

Series load(const PointTracks& tracks, std::uint32_t first) {
  Series series{first, std::min<Index>(kChunk, tracks.count() - first), {}, {}};
  series.light = MatrixXd::Zero(tracks.frames(), 3 * series.count);
  series.seen = MatrixXd::Zero(tracks.frames(), series.count);
  for (int t = 0; t < tracks.frames(); ++t) {
    for (const TrackSample& sample : tracks.samples(t, first, first + kChunk)) {
      if (!sample.is_usable) continue;
      const Index at = sample.track - first;
      series.seen(t, at) = 1.0;
      for (int c = 0; c < 3; ++c) {
        series.light(t, 3 * at + c) = static_cast<double>(sample.light[c]);
      }
    }
  }
  return series;
}

void for_each_chunk(const PointTracks& tracks,
                    const std::function<void(std::size_t, Series&)>& body) {
  const int chunks = static_cast<int>((tracks.count() + kChunk - 1) / kChunk);
  parallel_for(chunks, [&](int i) {
    Series series = load(tracks, static_cast<std::uint32_t>(i) * kChunk);
    body(static_cast<std::size_t>(i), series);
  });
}

std::size_t chunk_count(const PointTracks& tracks) {
  return (tracks.count() + kChunk - 1) / kChunk;
}

// Bases of one track by least squares over the frames that show it: the first `used` of them.
SmallBases fit_track(const Series& series, Index track, const MatrixXd& weights, int used) {
  SmallMatrix normal = SmallMatrix::Zero(used, used);
  SmallBases right = SmallBases::Zero(used, 3);
  for (Index t = 0; t < weights.rows(); ++t) {
    if (!(series.seen(t, track) > 0.0)) continue;
    const auto w = weights.row(t).head(used);
    normal.noalias() += w.transpose() * w;
    right.noalias() += w.transpose() * series.light.row(t).segment<3>(3 * track);
  }
  normal.diagonal().array() += kRidge * normal.diagonal().maxCoeff();
  return normal.ldlt().solve(right);
}

// Normal equations of each frame's weights, given the bases of all tracks.
class FrameEquations {
 public:
  FrameEquations(Index frames, Index bases)
      : normal_(MatrixXd::Zero(frames * bases, bases)),
        right_(MatrixXd::Zero(frames, bases)),
        energy_(MatrixXd::Zero(bases, bases)) {}

  void add(const Series& series, Index track, const SmallBases& fit) {
    const Index used = fit.rows(), bases = energy_.rows();
    const SmallMatrix square = fit * fit.transpose();
    energy_.topLeftCorner(used, used) += square;
    for (Index t = 0; t < right_.rows(); ++t) {
      if (!(series.seen(t, track) > 0.0)) continue;
      normal_.block(t * bases, 0, used, used) += square;
      right_.row(t).head(used) +=
          (fit * series.light.row(t).segment<3>(3 * track).transpose()).transpose();
    }
  }
  FrameEquations& operator+=(const FrameEquations& other) {
    normal_ += other.normal_;
    right_ += other.right_;
    energy_ += other.energy_;
    return *this;
  }
  // A frame without any light keeps its weights.
  [[nodiscard]] MatrixXd solve(const MatrixXd& known) const {
    const Index bases = energy_.rows();
    MatrixXd weights = known;
    for (Index t = 0; t < right_.rows(); ++t) {
      MatrixXd normal = normal_.middleRows(t * bases, bases);
      const double largest = normal.diagonal().maxCoeff();
      if (!(largest > 0.0)) continue;
      normal.diagonal().array() += kRidge * largest;
      weights.row(t) = normal.ldlt().solve(right_.row(t).transpose()).transpose();
    }
    return weights;
  }
  [[nodiscard]] const MatrixXd& energy() const { return energy_; }  // sum of B B^T

 private:
  MatrixXd normal_;  // one frame's matrix below the other's
  MatrixXd right_, energy_;
};

MatrixXd leading_eigenvectors(const MatrixXd& symmetric, Index count) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return solver.eigenvectors().rowwise().reverse().leftCols(count);
}

}  // namespace

void TrackPcaOptions::validate() const {
  EL_CHECK(bases >= 1 && bases <= kMostBases, "bases {}: expected 1 to {}", bases, kMostBases);
  EL_CHECK(frames_per_basis >= 1 && frames_per_basis <= 64, "frames_per_basis {}: expected 1 to 64",
           frames_per_basis);
  EL_CHECK(sweeps >= 0 && sweeps <= 100, "sweeps {}: expected 0 to 100", sweeps);
}

TrackPca::TrackPca(const PointTracks& tracks, const TrackPcaOptions& options)
    : options_(options), seen_(tracks.count()) {
  options.validate();
  for (int t = 0; t < tracks.frames(); ++t) {
    for (const TrackSample& sample : tracks.samples(t)) seen_[sample.track] += sample.is_usable;
  }
  is_full_ = std::all_of(seen_.begin(), seen_.end(),
                         [&](int seen) { return seen == 0 || seen == tracks.frames(); });
  find_weights(tracks);
  for (int i = 0; i < options_.sweeps && !is_full_; ++i) sweep(tracks);
  find_bases(tracks);
}

int TrackPca::bases_of(std::uint32_t track) const {
  const int seen = seen_[track];
  if (seen == 0) return 0;
  return std::clamp(seen / options_.frames_per_basis, 1, bases());
}

glm::vec3 TrackPca::light(std::uint32_t track, int t) const {
  glm::vec3 sum(0.0f);
  const std::size_t base = static_cast<std::size_t>(track) * static_cast<std::size_t>(bases());
  for (int i = 0; i < bases_of(track); ++i) {
    sum += static_cast<float>(weights_(t, i)) * values_[base + static_cast<std::size_t>(i)];
  }
  return sum;
}

void TrackPca::find_weights(const PointTracks& tracks) {
  struct Pairs {
    MatrixXd products, counts;
  };
  std::vector<Pairs> parts(chunk_count(tracks));
  for_each_chunk(tracks, [&](std::size_t chunk, Series& series) {
    parts[chunk] = {series.light * series.light.transpose(), series.seen * series.seen.transpose()};
  });
  const Index frames = tracks.frames();
  Pairs sum{MatrixXd::Zero(frames, frames), MatrixXd::Zero(frames, frames)};
  for (const Pairs& part : parts) {
    sum.products += part.products;
    sum.counts += part.counts;
  }
  const MatrixXd gram = sum.products.cwiseQuotient(sum.counts.cwiseMax(1.0));
  weights_ = leading_eigenvectors(gram, std::min<Index>(options_.bases, frames));
}

// Least squares: bases from weights, and from those new weights.
void TrackPca::sweep(const PointTracks& tracks) {
  std::vector<FrameEquations> parts(chunk_count(tracks), {weights_.rows(), weights_.cols()});
  for_each_chunk(tracks, [&](std::size_t chunk, Series& series) {
    for (Index track = 0; track < series.count; ++track) {
      const int used = bases_of(series.first + static_cast<std::uint32_t>(track));
      if (used == 0) continue;
      parts[chunk].add(series, track, fit_track(series, track, weights_, used));
    }
  });
  FrameEquations sum(weights_.rows(), weights_.cols());
  for (const FrameEquations& part : parts) sum += part;
  const MatrixXd next = sum.solve(weights_);
  // Orthonormal again, by falling energy of the bases that belong to them.
  const Eigen::HouseholderQR<MatrixXd> qr(next);
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(next.rows(), next.cols());
  const MatrixXd r = q.transpose() * next;
  weights_ = q * leading_eigenvectors(r * sum.energy() * r.transpose(), next.cols());
}

void TrackPca::find_bases(const PointTracks& tracks) {
  const std::size_t stride = static_cast<std::size_t>(bases());
  values_.assign(tracks.count() * stride, glm::vec3(0.0f));
  for_each_chunk(tracks, [&](std::size_t, Series& series) {
    for (Index i = 0; i < series.count; ++i) {
      const std::uint32_t track = series.first + static_cast<std::uint32_t>(i);
      const int used = bases_of(track);
      if (used == 0) continue;
      const SmallBases fit = fit_track(series, i, weights_, used);
      for (int k = 0; k < used; ++k) {
        values_[track * stride + static_cast<std::size_t>(k)] =
            glm::vec3(glm::dvec3(fit(k, 0), fit(k, 1), fit(k, 2)));
      }
    }
  });
}

}  // namespace eigenlight
