#include "spatial/training/structural_loss.h"

#include <array>
#include <cmath>
#include <vector>

namespace eigenlight {
namespace {

constexpr int kWindow = 7;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // Wang et al. 2004
// Tried 0, 0.1, 0.3 and 1: docs/experiments/2026-11-pyramid.md.
constexpr double kStructuralShare = 0.1;

struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

// SSIM of a window and its derivatives by mean a, mean a^2 and mean a b.
struct Similarity {
  double value = 0, by_a = 0, by_aa = 0, by_ab = 0;
};

Similarity similarity(const Moments& m) {
  const double luminance_over = 2.0 * m.a * m.b + kC1;
  const double luminance_under = m.a * m.a + m.b * m.b + kC1;
  const double structure_over = 2.0 * (m.ab - m.a * m.b) + kC2;
  const double structure_under = m.aa - m.a * m.a + m.bb - m.b * m.b + kC2;
  const double luminance = luminance_over / luminance_under;
  const double structure = structure_over / structure_under;
  const double luminance_by_a = 2.0 * (m.b - luminance * m.a) / luminance_under;
  const double structure_by_a = 2.0 * (structure * m.a - m.b) / structure_under;
  return {luminance * structure, luminance_by_a * structure + luminance * structure_by_a,
          -luminance * structure / structure_under, 2.0 * luminance / structure_under};
}

class ChannelLoss {
 public:
  ChannelLoss(const Plane<float>& a, const Plane<float>& b)
      : a_(a),
        b_(b),
        side_{std::min(kWindow, a.width()), std::min(kWindow, a.height())},
        gradient_(a.extent().pixels()) {}

  void run(double share_of_absolute, double share_of_structural) {
    for (int y = 0; y + side_.height <= a_.height(); ++y) {
      for (int x = 0; x + side_.width <= a_.width(); ++x) window(x, y, share_of_structural);
    }
    for (int y = 0; y < a_.height(); ++y) {
      for (int x = 0; x < a_.width(); ++x) {
        const double d = static_cast<double>(a_(x, y)) - static_cast<double>(b_(x, y));
        loss.absolute += std::abs(d) * share_of_absolute;
        gradient_[index(x, y)] += d == 0.0 ? 0.0 : std::copysign(share_of_absolute, d);
      }
    }
  }
  void store(Plane<float>& gradient) const {
    for (int y = 0; y < a_.height(); ++y) {
      for (int x = 0; x < a_.width(); ++x) {
        gradient(x, y) = static_cast<float>(gradient_[index(x, y)]);
      }
    }
  }
  [[nodiscard]] int windows() const {
    return (a_.width() - side_.width + 1) * (a_.height() - side_.height + 1);
  }

  ImageLoss loss;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(a_.width()) +
           static_cast<std::size_t>(x);
  }
  template <typename Body>
  void for_window(int x0, int y0, const Body& body) {
    for (int y = y0; y < y0 + side_.height; ++y) {
      for (int x = x0; x < x0 + side_.width; ++x) {
        body(index(x, y), static_cast<double>(a_(x, y)), static_cast<double>(b_(x, y)));
      }
    }
  }
  void window(int x0, int y0, double share) {
    const double each = 1.0 / static_cast<double>(side_.pixels());
    Moments m;
    for_window(x0, y0, [&](std::size_t, double a, double b) {
      m.a += a * each, m.b += b * each;
      m.aa += a * a * each, m.bb += b * b * each, m.ab += a * b * each;
    });
    const Similarity s = similarity(m);
    loss.structural += (1.0 - s.value) * share;
    const double scale = -kStructuralShare * share * each;
    for_window(x0, y0, [&](std::size_t at, double a, double b) {
      gradient_[at] += scale * (s.by_a + 2.0 * a * s.by_aa + b * s.by_ab);
    });
  }

  const Plane<float>& a_;
  const Plane<float>& b_;
  Extent side_;
  std::vector<double> gradient_;
};

}  // namespace

double ImageLoss::total() const { return absolute + kStructuralShare * structural; }

ImageLoss image_loss(const Planes<3>& a, const Planes<3>& b, Planes<3>& gradient) {
  const Extent extent = a[0].extent();
  EL_CHECK(b[0].extent() == extent && gradient[0].extent() == extent,
           "loss of images that differ in size");
  ImageLoss sum;
  for (std::size_t c = 0; c < 3; ++c) {
    ChannelLoss channel(a[c], b[c]);
    channel.run(1.0 / (3.0 * static_cast<double>(extent.pixels())),
                1.0 / (3.0 * static_cast<double>(channel.windows())));
    channel.store(gradient[c]);
    sum.absolute += channel.loss.absolute;
    sum.structural += channel.loss.structural;
  }
  return sum;
}

}  // namespace eigenlight
