#include "sequences/metrics/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

constexpr int kRadius = 5;  // an 11x11 window
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;
// Wang et al. 2003, fitted to human judgment.
constexpr std::array<double, 5> kScaleWeights{0.0448, 0.2856, 0.3001, 0.2363, 0.1333};
constexpr int kMinSide = (2 * kRadius + 1) << 4;

std::array<double, kRadius + 1> gaussian() {
  std::array<double, kRadius + 1> kernel{};
  for (int i = 0; i <= kRadius; ++i) {
    kernel[static_cast<std::size_t>(i)] = std::exp(-0.5 * i * i / (1.5 * 1.5));
  }
  return kernel;
}

// Weighted sums that a window needs, side by side: w, w a, w b, w a^2, w b^2, w a b.
constexpr int kMoments = 6;

Plane<double> moments(const SsimInputs& in) {
  Plane<double> out(in.a.extent(), kMoments);
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      const double w = in.weight(x, y);
      if (w == 0.0) continue;  // the values may be NaN
      const double a = in.a(x, y), b = in.b(x, y);
      double* m = out.at(x, y);
      m[0] = w, m[1] = w * a, m[2] = w * b;
      m[3] = w * a * a, m[4] = w * b * b, m[5] = w * a * b;
    }
  }
  return out;
}

// Sums over a window of one axis.
Plane<double> blur(const Plane<double>& in, int dx, int dy) {
  static const auto kernel = gaussian();
  Plane<double> out(in.extent(), kMoments);
  parallel_for(in.height(), [&](int y) {
    for (int x = 0; x < in.width(); ++x) {
      double* sum = out.at(x, y);
      for (int k = -kRadius; k <= kRadius; ++k) {
        const int sx = x + k * dx, sy = y + k * dy;
        if (!in.extent().contains(sx, sy)) continue;
        const double g = kernel[static_cast<std::size_t>(std::abs(k))];
        const double* from = in.at(sx, sy);
        for (int m = 0; m < kMoments; ++m) sum[m] += g * from[m];
      }
    }
  });
  return out;
}

Plane<double> halve(const Plane<double>& in, const Plane<double>* weight) {
  Plane<double> out(Extent{in.width() / 2, in.height() / 2});
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      double sum = 0.0, total = 0.0;
      for (int i = 0; i < 4; ++i) {
        const int sx = 2 * x + i % 2, sy = 2 * y + i / 2;
        const double w = weight ? (*weight)(sx, sy) : 1.0;
        if (w == 0.0) continue;
        sum += w * in(sx, sy);
        total += w;
      }
      out(x, y) = total > 0.0 ? sum / total : 0.0;
    }
  }
  return out;
}

template <typename Value>
std::optional<double> weighted_mean(const Plane<double>& set, const Value& value) {
  double sum = 0.0, total = 0.0;
  for (int y = 0; y < set.height(); ++y) {
    for (int x = 0; x < set.width(); ++x) {
      const double w = set(x, y);
      if (w == 0.0) continue;
      sum += w * value(x, y);
      total += w;
    }
  }
  if (total == 0.0) return std::nullopt;
  return sum / total;
}

std::optional<double> mean_ssim(const SsimMaps& maps, const Plane<double>& set) {
  return weighted_mean(set,
                       [&](int x, int y) { return maps.luminance(x, y) * maps.structure(x, y); });
}

}  // namespace

SsimMaps ssim_maps(const SsimInputs& in) {
  EL_CHECK(in.a.extent() == in.b.extent() && in.a.extent() == in.weight.extent(),
           "SSIM of images that differ in size");
  const Plane<double> sums = blur(blur(moments(in), 1, 0), 0, 1);
  SsimMaps maps{Plane<double>(in.a.extent()), Plane<double>(in.a.extent())};
  parallel_for(in.a.height(), [&](int y) {
    for (int x = 0; x < in.a.width(); ++x) {
      const double* m = sums.at(x, y);
      if (m[0] == 0.0) continue;  // no pixel in this window
      const double mean_a = m[1] / m[0], mean_b = m[2] / m[0];
      const double var_a = m[3] / m[0] - mean_a * mean_a;
      const double var_b = m[4] / m[0] - mean_b * mean_b;
      const double covariance = m[5] / m[0] - mean_a * mean_b;
      maps.luminance(x, y) =
          (2.0 * mean_a * mean_b + kC1) / (mean_a * mean_a + mean_b * mean_b + kC1);
      maps.structure(x, y) = (2.0 * covariance + kC2) / (var_a + var_b + kC2);
    }
  });
  return maps;
}

SsimPyramid::SsimPyramid(const SsimInputs& in) {
  scales_.push_back(ssim_maps(in));
  if (in.a.width() < kMinSide || in.a.height() < kMinSide) return;
  Plane<double> a = in.a.clone(), b = in.b.clone(), weight = in.weight.clone();
  while (scales_.size() < kScaleWeights.size()) {
    a = halve(a, &weight);
    b = halve(b, &weight);
    weight = halve(weight, nullptr);
    scales_.push_back(ssim_maps({a, b, weight}));
  }
}

std::optional<double> SsimPyramid::ssim(const Plane<double>& set) const {
  return mean_ssim(scales_.front(), set);
}

std::optional<double> SsimPyramid::ms_ssim(const Plane<double>& set) const {
  if (scales_.size() < kScaleWeights.size()) return std::nullopt;
  Plane<double> set_here = set.clone();
  double product = 1.0;
  for (std::size_t s = 0; s < scales_.size(); ++s) {
    if (s > 0) set_here = halve(set_here, nullptr);
    const SsimMaps& maps = scales_[s];
    const auto mean =
        s + 1 == scales_.size()
            ? mean_ssim(maps, set_here)
            : weighted_mean(set_here, [&](int x, int y) { return maps.structure(x, y); });
    if (!mean) return std::nullopt;
    product *= std::pow(std::max(*mean, 0.0), kScaleWeights[s]);
  }
  return product;
}

}  // namespace eigenlight
