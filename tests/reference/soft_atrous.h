// SoftAtrous as its header writes it down, in double, pixel by pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/luminance.h"
#include "spatial/soft_atrous.h"

namespace eigenlight::reference {

inline double falloff(double x) { return x < 8.0 ? std::pow(1.0 - x / 8.0, 8.0) : 0.0; }

/// One layer in double.
struct SoftPicture {
  Extent extent;
  std::vector<std::array<double, 4>> pixels;  // r, g, b, variance

  [[nodiscard]] std::array<double, 4>& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
  [[nodiscard]] const std::array<double, 4>& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y * extent.width + x)];
  }
};

class SoftFilter {
 public:
  SoftFilter(const Plane<PackedGuide>& guides, const SoftAtrousOptions& options)
      : guides_(guides), options_(options) {}

  [[nodiscard]] double geometry(int px, int py, int qx, int qy) const {
    const PackedGuide &p = guides_(px, py), &q = guides_(qx, qy);
    if (!shows_surface(q)) return 0.0;
    double square = std::pow(p.depth - q.depth, 2.0);
    for (std::size_t i = 0; i < 6; ++i) {
      square += std::pow(p.normal_color[i] - q.normal_color[i], 2.0);
    }
    return falloff(square / std::pow(static_cast<double>(kGuideSteps), 2.0));
  }

  /// Mean of luminance over 3 x 3 pixels, and the variance of that mean.
  [[nodiscard]] std::array<double, 2> mean(const SoftPicture& in, int x, int y) const {
    double sum = 0.0, squares = 0.0, light = 0.0, spread = 0.0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!in.extent.contains(x + dx, y + dy)) continue;
        const double kernel = (2 - std::abs(dx)) * (2 - std::abs(dy)) / 16.0;
        const double w = kernel * (dx == 0 && dy == 0 ? 1.0 : geometry(x, y, x + dx, y + dy));
        const auto& q = in.at(x + dx, y + dy);
        sum += w, squares += w * w, spread += w * q[3];
        light += w * luminance(q[0], q[1], q[2]);
      }
    }
    return {light / sum, spread / sum * squares / (sum * sum)};
  }

  [[nodiscard]] SoftPicture pass(const SoftPicture& in, double sigmas, int index) const {
    SoftPicture out = in;
    for (int y = 0; y < in.extent.height; ++y) {
      for (int x = 0; x < in.extent.width; ++x) {
        if (!shows_surface(guides_(x, y))) {
          out.at(x, y) = {};
          continue;
        }
        out.at(x, y) = pixel(in, sigmas, 1 << index, x, y);
      }
    }
    return out;
  }

 private:
  [[nodiscard]] std::array<double, 4> pixel(const SoftPicture& in, double sigmas, int step, int x,
                                            int y) const {
    const std::vector<double> kernel =
        options_.radius == 1 ? std::vector<double>{0.25, 0.5, 0.25}
                             : std::vector<double>{1 / 16.0, 0.25, 0.375, 0.25, 1 / 16.0};
    const auto own = mean(in, x, y);
    const auto tolerance = [&](const std::array<double, 2>& m) {
      return sigmas * std::sqrt(m[1]) + 1e-4 * std::abs(m[0]) + 1e-6;
    };
    std::array<double, 4> result{};
    double sum = 0.0;
    for (int j = -options_.radius; j <= options_.radius; ++j) {
      for (int i = -options_.radius; i <= options_.radius; ++i) {
        const int qx = x + i * step, qy = y + j * step;
        if (!in.extent.contains(qx, qy)) continue;
        double w = kernel[static_cast<std::size_t>(i + options_.radius)] *
                   kernel[static_cast<std::size_t>(j + options_.radius)];
        if (i != 0 || j != 0) {
          const auto other = mean(in, qx, qy);
          w *= geometry(x, y, qx, qy) *
               falloff(2.0 * std::abs(other[0] - own[0]) / (tolerance(own) + tolerance(other)));
        }
        sum += w;
        for (std::size_t c = 0; c < 3; ++c) result[c] += w * in.at(qx, qy)[c];
        result[3] += w * w * in.at(qx, qy)[3];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) result[c] /= sum;
    result[3] /= sum * sum;
    return result;
  }

  const Plane<PackedGuide>& guides_;
  SoftAtrousOptions options_;
};

}  // namespace eigenlight::reference
