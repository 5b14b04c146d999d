// Fig. 15 of Chen 2012: the bases of incremental PCA.
#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "sequences/lab/paper_chen2012.h"
#include "sequences/lab/paper_scene.h"
#include "temporal/baselines/chen2012.h"

namespace eigenlight {
namespace {

constexpr int kSpp = 3;
constexpr int kEigenimages = 4, kEpochs = 70;

float weight_of_age(float age) { return std::min(1.0f, (1.0f + Chen2012::kAmnesia) / age); }

bool is_usable(const Frame& frame, int x, int y) {
  const auto& u = frame.lights[0].radiance;
  return frame.surface.id(x, y) != 0 && std::isfinite(u[0](x, y) + u[1](x, y) + u[2](x, y));
}

// Incremental PCA with a weight for each pixel.
class Learner {
 public:
  Learner(Extent extent, int bases)
      : pca_(extent, bases), bases_(extent, bases), age_(extent), weight_(extent) {}

  void learn(const Frame& frame) {
    number_ = std::min(number_ + 1, kMaxBases + 1);
    for (int y = 0; y < age_.height(); ++y) {
      for (int x = 0; x < age_.width(); ++x) {
        age_(x, y) += 1.0f;
        weight_(x, y) = is_usable(frame, x, y) ? weight_of_age(age_(x, y)) : 0.0f;
      }
    }
    pca_.update({frame.lights[0].radiance, weight_, number_}, bases_);
  }
  [[nodiscard]] const BasisField& bases() const { return bases_; }

 private:
  ImagePca pca_;
  BasisField bases_;
  Plane<float> age_, weight_;
  int number_ = 0;
};

// One column per frame: all channels of usable surface pixels; other values are 0.
Eigen::MatrixXd data_matrix(const std::vector<Frame>& frames) {
  const Extent extent = frames.front().extent();
  Eigen::MatrixXd data(static_cast<Eigen::Index>(3 * extent.pixels()),
                       static_cast<Eigen::Index>(frames.size()));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Eigen::Index row = 0;
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          data(row++, static_cast<Eigen::Index>(f)) =
              is_usable(frames[f], x, y)
                  ? static_cast<double>(frames[f].lights[0].radiance[c](x, y))
                  : 0.0;
        }
      }
    }
  }
  return data;
}

Eigen::MatrixXd basis_matrix(const BasisField& bases) {
  const Extent extent = bases.extent();
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(3 * extent.pixels()), bases.bases());
  for (int k = 0; k < bases.bases(); ++k) {
    Eigen::Index row = 0;
    for (int y = 0; y < extent.height; ++y) {
      for (int x = 0; x < extent.width; ++x) {
        for (int c = 0; c < 3; ++c) matrix(row++, k) = static_cast<double>(bases.value(x, y, c, k));
      }
    }
  }
  return matrix;
}

// Share of the data's energy outside the span of the columns.
double left_over(const Eigen::MatrixXd& data, const Eigen::MatrixXd& columns) {
  const Eigen::BDCSVD<Eigen::MatrixXd> span(columns, Eigen::ComputeThinU);
  const Eigen::MatrixXd& u = span.matrixU();
  return (data - u * (u.transpose() * data)).squaredNorm() / data.squaredNorm();
}

}  // namespace

void chen_bases(const PaperRun& run, PaperReport& report) {
  run.step("Fig. 15, incremental and batch PCA");
  const PaperScene scene("atrium", Perturbation::kLights, run.extent);
  const std::vector<Frame> frames = scene.render(kSpp, run.frames);
  Learner learner(run.extent, kEigenimages);
  for (int epoch = 0; epoch < kEpochs; ++epoch) {
    for (const Frame& frame : frames) learner.learn(frame);
  }
  const Eigen::MatrixXd data = data_matrix(frames);
  const Eigen::MatrixXd learned = basis_matrix(learner.bases());
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(data, Eigen::ComputeThinU);
  const Eigen::MatrixXd batch = svd.matrixU().leftCols(kEigenimages);
  PageTable table{"Eigenimages of incremental and batch PCA",
                  fmt::format("{} frames, light moving, {} samples a pixel, {} passes; no mean is "
                              "subtracted, as in the paper",
                              frames.size(), kSpp, kEpochs),
                  "eigenimage",
                  {{"cosine"}, {"singular value"}},
                  {}};
  double least = 1.0;
  for (Eigen::Index k = 0; k < kEigenimages; ++k) {
    const double cosine = std::abs(learned.col(k).normalized().dot(batch.col(k)));
    least = std::min(least, cosine);
    table.rows.push_back({fmt::format("{}", k + 1), {cosine, svd.singularValues()[k]}});
  }
  const double ratio = left_over(data, learned) / left_over(data, batch);
  report.claims.push_back(
      {"Fig. 15", "4 bases of CCIPCA after 70 epochs reconstruct frames like those of batch PCA",
       "similar (pictures only)",
       fmt::format("{:.3f} times its residual energy, least cosine of bases {:.3f}", ratio, least),
       ratio > 1.05    ? Verdict::kNot
       : least >= 0.95 ? Verdict::kHeld
                       : Verdict::kInPart});
  report.sections.push_back({"Fig. 15: bases", "", {}, {std::move(table)}, {}});
}

}  // namespace eigenlight
