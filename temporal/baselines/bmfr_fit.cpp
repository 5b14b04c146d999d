#include "temporal/baselines/bmfr_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "frame/random.h"
#include "frame/tiles.h"
#include "frame/usable_surface.h"

namespace eigenlight {
namespace {

constexpr int kBlock = 32, kFeatures = 10, kPositionFeatures = 6;
constexpr int kFewestRows = 4 * kFeatures;

// The offsets of the authors' implementation, one a frame.
constexpr std::array<glm::ivec2, 16> kOffsets{{{-14, -14},
                                               {4, -6},
                                               {-8, 14},
                                               {8, 0},
                                               {-10, -8},
                                               {2, 12},
                                               {12, -12},
                                               {-10, 0},
                                               {12, 14},
                                               {-8, -16},
                                               {6, 6},
                                               {-2, -2},
                                               {6, -14},
                                               {-16, 12},
                                               {14, -4},
                                               {-6, 4}}};

using Features = Eigen::Matrix<float, kFeatures, 1>;

Features features_at(const FrameInput& guides, int x, int y) {
  const auto& n = guides.surface.normal;
  const glm::vec3 view =
      guides.camera.pixel_to_view(glm::vec2(x, y) + 0.5f) * guides.surface.depth(x, y);
  const glm::vec3 at = guides.camera.to_world(view);
  Features f;
  f << 1.0f, n[0](x, y), n[1](x, y), n[2](x, y), at.x, at.y, at.z, at.x * at.x, at.y * at.y,
      at.z * at.z;
  return f;
}

// Mirrors a coordinate until it lies inside the image.
int mirrored(int i, int size) {
  const int period = 2 * size;
  const int at = (i % period + period) % period;
  return at < size ? at : period - 1 - at;
}

// One block's fit.
class Block {
 public:
  // `corner` may lie outside the image.
  Block(const BmfrFitInputs& in, glm::ivec2 corner) : in_(in), corner_(corner) {
    gather();
    scale();
    solve();
  }

  void write(Planes<3>& out) const {
    const Extent extent = in_.usable.extent();
    for (int y = std::max(corner_.y, 0); y < std::min(corner_.y + kBlock, extent.height); ++y) {
      for (int x = std::max(corner_.x, 0); x < std::min(corner_.x + kBlock, extent.width); ++x) {
        const Color color = color_at(x, y);
        for (int c = 0; c < 3; ++c) {
          out[static_cast<std::size_t>(c)](x, y) = std::max(0.0f, color[c]);
        }
      }
    }
  }

 private:
  using Color = Eigen::RowVector3f;

  [[nodiscard]] Color color_at(int x, int y) const {
    const bool known = in_.usable(x, y) > 0.0f;
    if (!is_usable_surface(in_.guides.surface, x, y)) {
      const bool shown = known && in_.guides.surface.id(x, y) != 0;
      return shown ? light_at(x, y) : Color::Zero();
    }
    const Color color = scaled(features_at(in_.guides, x, y)).transpose() * weights_;
    return known ? color : color.cwiseMin(most_);
  }

  [[nodiscard]] Color light_at(int x, int y) const {
    return {in_.light[0](x, y), in_.light[1](x, y), in_.light[2](x, y)};
  }

  void gather() {
    const Extent extent = in_.usable.extent();
    for (int j = 0; j < kBlock; ++j) {
      for (int i = 0; i < kBlock; ++i) {
        const int x = mirrored(corner_.x + i, extent.width);
        const int y = mirrored(corner_.y + j, extent.height);
        if (!(in_.usable(x, y) > 0.0f) || !is_usable_surface(in_.guides.surface, x, y)) continue;
        a_.row(rows_) = features_at(in_.guides, x, y);
        b_.row(rows_) = light_at(x, y);
        place_[static_cast<std::size_t>(rows_)] = j * kBlock + i;
        ++rows_;
      }
    }
    if (rows_ > 0) most_ = b_.topRows(rows_).colwise().maxCoeff();
  }

  void scale() {
    if (rows_ == 0) return;
    const auto positions = a_.topRows(rows_).rightCols<kPositionFeatures>();
    low_ = positions.colwise().minCoeff();
    const Scale span = positions.colwise().maxCoeff() - low_.transpose();
    for (int k = 0; k < kPositionFeatures; ++k) factor_[k] = span[k] > 1.0f ? 1.0f / span[k] : 1.0f;
    for (int r = 0; r < rows_; ++r) a_.row(r) = scaled(a_.row(r)).transpose();
  }

  [[nodiscard]] Features scaled(Features f) const {
    auto positions = f.tail<kPositionFeatures>();
    positions = (positions - low_).cwiseProduct(factor_);
    return f;
  }

  void solve() {
    weights_.setZero();
    if (rows_ == 0) return;
    if (rows_ < kFewestRows) {
      weights_.row(0) = b_.topRows(rows_).colwise().mean();
      return;
    }
    for (int r = 0; r < rows_; ++r) {
      const auto at = static_cast<std::uint32_t>(place_[static_cast<std::size_t>(r)]);
      for (int k = 1; k < kFeatures; ++k) {
        const float random = to_unit(hash_key(static_cast<std::uint32_t>(in_.guides.index), at,
                                              static_cast<std::uint32_t>(k)));
        a_(r, k) += in_.noise * (2.0f * random - 1.0f);
      }
    }
    Eigen::Ref<Eigen::MatrixXf> used(a_.topRows(rows_));
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXf>> qr(used);  // in place
    weights_ = qr.solve(b_.topRows(rows_));
  }

  using Scale = Eigen::Matrix<float, kPositionFeatures, 1>;

  const BmfrFitInputs& in_;
  glm::ivec2 corner_;
  int rows_ = 0;
  Eigen::MatrixXf a_{kBlock * kBlock, kFeatures}, b_{kBlock * kBlock, 3};
  std::array<int, kBlock * kBlock> place_{};  // of each row in the block
  Scale low_ = Scale::Zero(), factor_ = Scale::Ones();
  Color most_ = Color::Zero();  // of the light in the fit
  Eigen::Matrix<float, kFeatures, 3> weights_;
};

}  // namespace

void bmfr_fit(const BmfrFitInputs& in, Planes<3>& out) {
  const Extent extent = in.usable.extent();
  EL_CHECK(
      in.guides.extent() == extent && in.light[0].extent() == extent && out[0].extent() == extent,
      "fit of {}x{}: got planes of another size", extent.width, extent.height);
  const glm::ivec2 first =
      kOffsets[static_cast<std::size_t>(in.jitter) % kOffsets.size()] - kBlock / 2;
  const glm::ivec2 count((extent.width - first.x + kBlock - 1) / kBlock,
                         (extent.height - first.y + kBlock - 1) / kBlock);
  parallel_for(count.x * count.y, [&](int i) {
    Block(in, first + kBlock * glm::ivec2(i % count.x, i / count.x)).write(out);
  });
}

}  // namespace eigenlight
