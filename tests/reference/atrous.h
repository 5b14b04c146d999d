// Twin of spatial/atrous: one pass over a whole image, in double, without tiles or skips.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "frame/usable_surface.h"
#include "spatial/atrous.h"

namespace eigenlight::reference {

/// Red, green, blue and variance of all pixels.
struct AtrousImage {
  Extent extent;
  std::array<std::vector<double>, 4> values;

  explicit AtrousImage(Extent size) : extent(size) {
    for (auto& plane : values) plane.assign(size.pixels(), 0.0);
  }
  AtrousImage(const Planes<3>& color, const Plane<float>& variance) : extent(variance.extent()) {
    for (std::size_t c = 0; c < 4; ++c) {
      const Plane<float>& plane = c < 3 ? color[c] : variance;
      for (int y = 0; y < extent.height; ++y) {
        values[c].insert(values[c].end(), plane.row(y), plane.row(y) + extent.width);
      }
    }
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(extent.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] double luminance(int x, int y) const {
    const std::size_t i = index(x, y);
    return 0.2126 * values[0][i] + 0.7152 * values[1][i] + 0.0722 * values[2][i];
  }
};

namespace detail {

inline glm::dvec3 guide_normal(const FrameInput& guides, glm::ivec2 p) {
  const auto& n = guides.surface.normal;
  return {n[0](p.x, p.y), n[1](p.x, p.y), n[2](p.x, p.y)};
}

inline glm::dvec3 guide_position(const FrameInput& guides, glm::ivec2 p) {
  const Camera& camera = guides.camera;
  const glm::dvec2 at =
      (glm::dvec2(p) + 0.5 - glm::dvec2(camera.center)) / static_cast<double>(camera.focal);
  return glm::transpose(glm::dmat3(camera.world_to_view)) *
         (glm::dvec3(at, 1.0) * static_cast<double>(guides.surface.depth(p.x, p.y)));
}

// Standard deviation from the 3 x 3 binomial mean of the variance, edges repeated.
inline double smooth_sigma(const AtrousImage& image, glm::ivec2 p) {
  double sum = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = std::clamp(p.x + dx, 0, image.extent.width - 1);
      const int y = std::clamp(p.y + dy, 0, image.extent.height - 1);
      sum += (2 - std::abs(dx)) * (2 - std::abs(dy)) * image.values[3][image.index(x, y)];
    }
  }
  return std::sqrt(sum / 16.0);
}

}  // namespace detail

/// Luminances g of an earlier picture, by AtrousImage::index; NaN: not known; empty: none.
using Earlier = std::vector<double>;

/// w(p, q) of the header.
inline double atrous_weight(const FrameInput& guides, const AtrousOptions& options,
                            const AtrousImage& image, const Earlier& earlier, glm::ivec2 p,
                            glm::ivec2 q) {
  if (p == q) return 1.0;
  if (guides.surface.id(q.x, q.y) == 0) return 0.0;
  const glm::dvec3 normal = detail::guide_normal(guides, p);
  const double cosine = std::max(0.0, glm::dot(normal, detail::guide_normal(guides, q)));
  if (!(cosine <= static_cast<double>(kLargestCosine))) return 0.0;
  const double depth = guides.surface.depth(p.x, p.y);
  if (!(depth > 0.0)) return 0.0;
  const double plane = std::abs(
      glm::dot(normal, detail::guide_position(guides, q) - detail::guide_position(guides, p)));
  const auto decay = [](double x) { return std::pow(std::max(0.0, 1.0 - x / 8.0), 8); };
  const double geometry = std::pow(cosine, 64) * decay(plane / (options.plane_distance * depth));
  if (std::isinf(options.luminance_sigmas)) return geometry;
  const double sigma = detail::smooth_sigma(image, p);
  const auto off = [](double own, double other, double tolerance) {
    return own == other || std::isnan(other - own) ? 0.0 : std::abs(other - own) / tolerance;
  };
  const double own = image.luminance(p.x, p.y);
  double light =
      off(own, image.luminance(q.x, q.y), options.luminance_sigmas * sigma + 1e-4 * std::abs(own));
  if (!earlier.empty()) {
    const double before = earlier[image.index(p.x, p.y)];
    light += off(before, earlier[image.index(q.x, q.y)],
                 options.earlier_sigmas * sigma + options.earlier_share * std::abs(before));
  }
  return geometry * decay(light);
}

inline AtrousImage atrous_pass(const FrameInput& guides, const AtrousOptions& options,
                               const AtrousImage& image, int step, const Earlier& earlier = {}) {
  const std::array<double, 3> kernel{1 / 4.0, 1 / 2.0, 1 / 4.0};
  AtrousImage out = image;
  for (int y = 0; y < image.extent.height; ++y) {
    for (int x = 0; x < image.extent.width; ++x) {
      if (guides.surface.id(x, y) == 0) continue;
      double weights = 0.0;
      std::array<double, 4> sum{};
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const glm::ivec2 q(x + (i - 1) * step, y + (j - 1) * step);
          if (!image.extent.contains(q.x, q.y)) continue;
          const double w = kernel[static_cast<std::size_t>(i)] *
                           kernel[static_cast<std::size_t>(j)] *
                           atrous_weight(guides, options, image, earlier, {x, y}, q);
          const std::size_t at = image.index(q.x, q.y);
          weights += w;
          for (std::size_t c = 0; c < 3; ++c) sum[c] += w * image.values[c][at];
          sum[3] += w * w * image.values[3][at];
        }
      }
      const std::size_t at = image.index(x, y);
      for (std::size_t c = 0; c < 3; ++c) out.values[c][at] = sum[c] / weights;
      out.values[3][at] = sum[3] / (weights * weights);
    }
  }
  return out;
}

}  // namespace eigenlight::reference
