// The equations of the guided filter in double, window by window, without tiles.
#pragma once

#include <Eigen/Dense>
#include <cmath>

#include "frame/usable_surface.h"
#include "spatial/guided_filter.h"

namespace eigenlight::reference {

using Guide = Eigen::VectorXd;
using Light = Eigen::Vector3d;

/// F = slope I + offset in the window around one pixel; `valid` if it counts in averages.
struct WindowFit {
  bool valid = false;
  Eigen::Matrix<double, 3, Eigen::Dynamic> slope;
  Light offset = Light::Zero();
};

inline bool has_surface(const FrameInput& frame, int x, int y) {
  return is_usable_surface(frame.surface, x, y);
}

inline Guide guide_at(const FrameInput& frame, Guides guides, int x, int y) {
  const auto& s = frame.surface;
  Guide all(4);
  all << s.normal[0](x, y), s.normal[1](x, y), s.normal[2](x, y),
      std::log(static_cast<double>(s.depth(x, y)));
  if (guides != Guides::kGrayNormal) return all.head(static_cast<int>(guides));
  return Guide::Constant(1, all.head(3).dot(Eigen::Vector3d(0.2126, 0.7152, 0.0722)));
}

inline double usable_weight(const GuidedInputs& in, int x, int y) {
  const double w = static_cast<double>(in.weight(x, y));
  bool finite = std::isfinite(w);
  for (const auto& plane : in.signal) finite = finite && std::isfinite(plane(x, y));
  return finite && w > 0.0 && has_surface(in.guides, x, y) ? w : 0.0;
}

template <typename Visit>
void for_window(Extent extent, glm::ivec2 center, int radius, const Visit& visit) {
  for (int y = center.y - radius; y <= center.y + radius; ++y) {
    for (int x = center.x - radius; x <= center.x + radius; ++x) {
      if (extent.contains(x, y)) visit(x, y);
    }
  }
}

/// Bauszat 2011, Eq. 8 and 9, with weighted expectations.
inline WindowFit fit_window(const GuidedInputs& in, const GuidedOptions& options,
                            glm::ivec2 center) {
  WindowFit fit;
  if (!has_surface(in.guides, center.x, center.y)) return fit;
  double sum = 0.0;
  const int n = static_cast<int>(options.guides);
  Guide mean = Guide::Zero(n);
  Light light = Light::Zero();
  const auto light_at = [&](int x, int y) {
    return Light(in.signal[0](x, y), in.signal[1](x, y), in.signal[2](x, y));
  };
  const auto each = [&](const auto& visit) {
    for_window(in.weight.extent(), center, options.radius, [&](int x, int y) {
      const double w = usable_weight(in, x, y);
      if (w > 0.0) visit(w, guide_at(in.guides, options.guides, x, y), light_at(x, y));
    });
  };
  each([&](double w, const Guide& guide, const Light& light_here) {
    sum += w;
    mean += w * guide;
    light += w * light_here;
  });
  if (sum == 0.0) return fit;
  mean /= sum;
  light /= sum;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n), cross = Eigen::MatrixXd::Zero(n, 3);
  each([&](double w, const Guide& guide, const Light& light_here) {
    covariance += w / sum * (guide - mean) * (guide - mean).transpose();
    cross += w / sum * (guide - mean) * (light_here - light).transpose();
  });
  for (int i = 0; i < n; ++i) {
    covariance(i, i) += static_cast<double>(i < 3 ? options.epsilon_normal : options.epsilon_depth);
  }
  fit.slope = covariance.ldlt().solve(cross).transpose();
  fit.offset = light - fit.slope * mean;
  fit.valid = true;
  return fit;
}

/// Fits of all pixels, row by row.
inline std::vector<WindowFit> fit_windows(const GuidedInputs& in, const GuidedOptions& options) {
  const Extent extent = in.weight.extent();
  std::vector<WindowFit> fits;
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) fits.push_back(fit_window(in, options, {x, y}));
  }
  return fits;
}

/// All pixels, whether `wanted` or not.
inline Planes<3> guided_filter(const GuidedInputs& in, const GuidedOptions& options) {
  const Extent extent = in.weight.extent();
  const std::vector<WindowFit> fits = fit_windows(in, options);
  Planes<3> out = make_planes<3>(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      if (!has_surface(in.guides, x, y)) continue;
      Light sum = Light::Zero();
      double count = 0.0;
      for_window(extent, {x, y}, options.radius, [&](int i, int j) {
        const WindowFit& fit = fits[static_cast<std::size_t>(j * extent.width + i)];
        if (!fit.valid) return;
        sum += fit.slope * guide_at(in.guides, options.guides, x, y) + fit.offset;
        count += 1.0;
      });
      if (count == 0.0) continue;
      for (int c = 0; c < 3; ++c) {
        out[static_cast<std::size_t>(c)](x, y) = static_cast<float>(sum[c] / count);
      }
    }
  }
  return out;
}

}  // namespace eigenlight::reference
