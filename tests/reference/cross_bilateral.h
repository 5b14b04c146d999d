// Twin of spatial/rivals/cross_bilateral: double, pixel by pixel.
#pragma once

#include <cmath>

#include "spatial/rivals/cross_bilateral.h"
#include "tests/reference/surface_points.h"
#include "tests/support/spatial_case.h"

namespace eigenlight::reference {

/// W(p, q) of the header without the weight of q.
inline double bilateral_weight(const FrameInput& frame, const CrossBilateralOptions& options,
                               glm::ivec2 p, glm::ivec2 q) {
  const SurfacePoint a = surface_point(frame, p), b = surface_point(frame, q);
  const glm::dvec2 offset(p - q);
  const double space = glm::dot(offset, offset) / std::pow(0.5 * options.radius, 2);
  const double normal =
      squared(a.normal - b.normal) / std::pow(static_cast<double>(options.sigma_normal), 2);
  const double albedo =
      squared(a.albedo - b.albedo) / std::pow(static_cast<double>(options.sigma_albedo), 2);
  const double plane = glm::dot(a.normal, b.position - a.position) /
                       (static_cast<double>(options.sigma_plane) * a.depth);
  return std::exp(-0.5 * (space + normal + albedo + plane * plane));
}

inline Planes<3> cross_bilateral(const SpatialCase& c, const CrossBilateralOptions& options) {
  Planes<3> out = make_planes<3>(c.extent());
  for (int y = 0; y < c.extent().height; ++y) {
    for (int x = 0; x < c.extent().width; ++x) {
      if (c.frame.surface.id(x, y) == 0) continue;
      glm::dvec3 sum(0.0);
      double weights = 0.0;
      for (int j = y - options.radius; j <= y + options.radius; ++j) {
        for (int i = x - options.radius; i <= x + options.radius; ++i) {
          if (!c.extent().contains(i, j) || !c.is_usable(i, j)) continue;
          const double w = static_cast<double>(c.weight(i, j)) *
                           bilateral_weight(c.frame, options, {x, y}, {i, j});
          sum += w * vector_at(c.signal, {i, j});
          weights += w;
        }
      }
      for (int k = 0; k < 3 && weights > 0.0; ++k) {
        out[static_cast<std::size_t>(k)](x, y) = static_cast<float>(sum[k] / weights);
      }
    }
  }
  return out;
}

}  // namespace eigenlight::reference
