// Twin of temporal/change/residual_cells in double: one cell or one pixel at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "reproject/taps.h"
#include "temporal/change/residual_cells.h"

namespace eigenlight::reference {

inline glm::dvec3 normal_at(const FrameInput& frame, int x, int y) {
  const auto& n = frame.surface.normal;
  return {n[0](x, y), n[1](x, y), n[2](x, y)};
}

struct Cell {
  std::uint32_t id = 0;
  double count = 0.0, noise = 0.0;
  std::array<double, 3> mean{};
};

/// `In` is CorrectionInputs, or its twin in double.
template <typename In>
Cell cell(const In& in, int cx, int cy) {
  Cell out;
  const Extent extent = in.guides.extent();
  const std::uint32_t id = in.guides.surface.id(2 * cx, 2 * cy);
  const glm::dvec3 normal = normal_at(in.guides, 2 * cx, 2 * cy);
  for (int y = 2 * cy; y < std::min(2 * cy + 2, extent.height); ++y) {
    for (int x = 2 * cx; x < std::min(2 * cx + 2, extent.width); ++x) {
      const bool first = x == 2 * cx && y == 2 * cy;
      const bool same = first || glm::dot(normal, normal_at(in.guides, x, y)) >=
                                     static_cast<double>(TapOptions{}.normal_cosine);
      if (std::isnan(in.innovation(x, y)) || in.guides.surface.id(x, y) != id || !same) continue;
      out.count += 1.0;
      out.noise += in.variance(x, y) * (1.0 / in.samples(x, y) + 1.0 / in.age(x, y));
      for (std::size_t c = 0; c < 3; ++c) {
        out.mean[c] += static_cast<double>(in.residual[c](x, y));
      }
    }
  }
  const double count = std::max(out.count, 1.0);
  out.id = out.count > 0.0 ? id : 0;
  out.noise /= count * count;
  for (double& mean : out.mean) mean /= count;
  return out;
}

/// The correction of pixel (x, y) from the cells around it: `cells` holds their geometry, and
/// mean(channel, x, y) their values.
template <typename Mean, typename In>
std::array<double, 3> spread(const FrameInput& cells, const Mean& mean, const In& in, int x,
                             int y) {
  if (std::isnan(in.innovation(x, y))) return {};
  const Camera& camera = in.guides.camera;
  const glm::dvec3 normal = normal_at(in.guides, x, y);
  const glm::dvec3 view = glm::dmat3(camera.world_to_view) * normal;
  // Along the view-space ray with z = 1 through a pixel's center.
  const auto along = [&](double px, double py) {
    const double focal = camera.focal;
    return view.x * (px + 0.5 - camera.center.x) / focal +
           view.y * (py + 0.5 - camera.center.y) / focal + view.z;
  };
  const double depth = in.guides.surface.depth(x, y), plane = depth * along(x, y);
  const TapOptions taps;
  std::array<double, 3> sum{};
  double total = 0.0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const int cx = std::clamp(x / 2 + i * (2 * (x % 2) - 1), 0, cells.extent().width - 1);
      const int cy = std::clamp(y / 2 + j * (2 * (y % 2) - 1), 0, cells.extent().height - 1);
      if (cells.surface.id(cx, cy) != in.guides.surface.id(x, y)) continue;
      const double off = std::abs(cells.surface.depth(cx, cy) * along(2 * cx, 2 * cy) - plane);
      const double cosine = glm::dot(normal, normal_at(cells, cx, cy));
      const bool same = off <= taps.plane_distance * depth && cosine >= taps.normal_cosine;
      const double weight = (i == 0 ? 0.75 : 0.25) * (j == 0 ? 0.75 : 0.25) * (same ? 1.0 : 1e-3);
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * mean(c, cx, cy);
      total += weight;
    }
  }
  for (double& value : sum) value = total > 0.0 ? value / total : 0.0;
  return sum;
}

}  // namespace eigenlight::reference
