// Fig. 5 and 15 of Chen 2012: what incremental PCA learns, and how fast.
#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "sequences/paper_chen2012.h"
#include "sequences/paper_scene.h"
#include "temporal/baselines/chen2012.h"

namespace eigenlight {
namespace {

constexpr int kSpp = 3;
constexpr int kDisoccludedBases = 3;
// Frames before the region is lost, and the most that it gets to recover.
constexpr int kBefore = 50, kAfter = 60;
// Chen 2012, Fig. 5: iterations of per-pixel weights that uniform ones are measured by.
constexpr int kPerPixelFrames = 5;
constexpr int kReferenceSpp = 64;
// Fig. 15.
constexpr int kEigenimages = 4, kEpochs = 70;

float weight_of_age(float age) { return std::min(1.0f, (1.0f + Chen2012::kAmnesia) / age); }

bool is_usable(const Frame& frame, int x, int y) {
  const auto& u = frame.indirect;
  return frame.surface.id(x, y) != 0 && std::isfinite(u[0](x, y) + u[1](x, y) + u[2](x, y));
}

// In the middle, a quarter of each side; surfaces only.
Plane<std::uint32_t> lost_region(const Frame& frame) {
  const Extent extent = frame.extent();
  Plane<std::uint32_t> region(extent);
  for (int y = extent.height * 3 / 8; y < extent.height * 5 / 8; ++y) {
    for (int x = extent.width * 3 / 8; x < extent.width * 5 / 8; ++x) {
      region(x, y) = frame.surface.id(x, y) != 0 ? 1u : 0u;
    }
  }
  return region;
}

// Incremental PCA with a weight for each pixel.
class Learner {
 public:
  Learner(Extent extent, int bases)
      : pca_(extent, bases), bases_(extent, bases), age_(extent), weight_(extent) {
    picture_ = make_planes<3>(extent);
  }

  /// Bases and ages of the region become 0, as at pixels that were not seen before.
  void lose(const Plane<std::uint32_t>& region, bool forgets_age) {
    for (int y = 0; y < region.height(); ++y) {
      for (int x = 0; x < region.width(); ++x) {
        if (region(x, y) == 0) continue;
        std::fill_n(bases_.pixel(x, y), bases_.pixel_floats(), 0.0f);
        if (forgets_age) age_(x, y) = 0.0f;
      }
    }
    pca_.orthogonalize(bases_);
  }
  void learn(const Frame& frame) {
    number_ = std::min(number_ + 1, kMaxBases + 1);
    for (int y = 0; y < age_.height(); ++y) {
      for (int x = 0; x < age_.width(); ++x) {
        age_(x, y) += 1.0f;
        weight_(x, y) = is_usable(frame, x, y) ? weight_of_age(age_(x, y)) : 0.0f;
      }
    }
    pca_.update({frame.indirect, weight_, number_}, bases_);
  }
  [[nodiscard]] const Planes<3>& reconstruct(const Frame& frame) {
    (void)pca_.reconstruct({frame.indirect, weight_, number_}, bases_, picture_);
    return picture_;
  }
  [[nodiscard]] const BasisField& bases() const { return bases_; }

 private:
  ImagePca pca_;
  BasisField bases_;
  Plane<float> age_, weight_;
  Planes<3> picture_;
  int number_ = 0;
};

struct Recovery {
  const PaperScene& scene;
  const std::vector<Frame>& frames;
  std::array<Planes<3>, 2> truth;

  // Error in the region after each frame since it was lost.
  [[nodiscard]] PlotSeries run(const std::string& name, bool per_pixel) const {
    const Plane<std::uint32_t> region = lost_region(frames.front());
    Learner learner(region.extent(), kDisoccludedBases);
    PlotSeries series{name, {}};
    for (int f = 0; f < kBefore + kAfter; ++f) {
      if (f == kBefore) learner.lose(region, per_pixel);
      const Frame& frame = frames[static_cast<std::size_t>(f)];
      learner.learn(frame);
      if (f < kBefore) continue;
      const Planes<3> picture = scene.shown(frame, learner.reconstruct(frame));
      series.points.push_back(
          {static_cast<double>(f - kBefore + 1), mean_square(picture, truth[0], truth[1], region)});
    }
    return series;
  }
};

void claim_recovery(const PlotSeries& per_pixel, const PlotSeries& uniform, PaperReport& report) {
  const double aim = per_pixel.points[kPerPixelFrames - 1].y;
  const auto there = std::find_if(uniform.points.begin(), uniform.points.end(),
                                  [&](const PlotPoint& point) { return point.y <= aim; });
  const bool arrives = there != uniform.points.end();
  const double frames = arrives ? there->x : static_cast<double>(kAfter + 1);
  report.claims.push_back(
      {"Fig. 5", "frames that uniform weights take for what per-pixel weights give after 5", "50",
       arrives ? fmt::format("{:.0f}", frames) : fmt::format("more than {}", kAfter),
       frames >= 50.0             ? Verdict::kHeld
       : frames > kPerPixelFrames ? Verdict::kInPart
                                  : Verdict::kNot});
}

// A column a frame: all channels of usable surface pixels, other values 0.
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
              is_usable(frames[f], x, y) ? static_cast<double>(frames[f].indirect[c](x, y)) : 0.0;
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

// Share of the data's energy that is left outside the span of the columns.
double left_over(const Eigen::MatrixXd& data, const Eigen::MatrixXd& columns) {
  const Eigen::BDCSVD<Eigen::MatrixXd> span(columns, Eigen::ComputeThinU);
  const Eigen::MatrixXd& u = span.matrixU();
  return (data - u * (u.transpose() * data)).squaredNorm() / data.squaredNorm();
}

}  // namespace

void chen_disocclusion(const PaperRun& run, PaperReport& report) {
  run.step("Fig. 5, frames and references");
  const PaperScene scene("atrium", Perturbation::kNone, run.extent);
  std::vector<int> numbers(kBefore + kAfter);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<int>(i);
  const std::vector<Frame> frames = scene.render(kSpp, numbers);
  Recovery recovery{scene, frames, {}};
  for (std::size_t half = 0; half < 2; ++half) {
    const std::uint32_t seed = half == 0 ? kPaperReferenceA : kPaperReferenceB;
    const std::vector<Frame> one = scene.render(kReferenceSpp, {0}, seed);
    recovery.truth[half] = scene.shown(one.front(), one.front().indirect);
  }
  run.step("Fig. 5, both weights");
  PagePlot plot{"Error in a region whose bases are lost",
                fmt::format("the middle of the picture, after {} frames at {} samples a pixel; "
                            "camera and light at rest; {} bases",
                            kBefore, kSpp, kDisoccludedBases),
                {"frames since"},
                {"mean squared error", true},
                {recovery.run("per-pixel weights", true), recovery.run("uniform weights", false)}};
  claim_recovery(plot.series[0], plot.series[1], report);
  report.sections.push_back({"Fig. 5: newly seen pixels", "", {std::move(plot)}, {}, {}});
}

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
      {"Fig. 15", "4 bases of CCIPCA after 70 epochs rebuild frames as batch PCA's do",
       "similar (pictures only)",
       fmt::format("{:.3f} of its residual energy, least cosine of bases {:.3f}", ratio, least),
       ratio > 1.05    ? Verdict::kNot
       : least >= 0.95 ? Verdict::kHeld
                       : Verdict::kInPart});
  report.sections.push_back({"Fig. 15: bases", "", {}, {std::move(table)}, {}});
}

}  // namespace eigenlight
