// The filter that the pyramid approximates, by brute force: what training and measurements aim at.
#pragma once

#include <algorithm>
#include <cmath>

#include "spatial/pyramid.h"

namespace eigenlight {

/// Xu et al. 2024, Eq. 1, with weights:
///   out(p) = sum_q I(q) w(q) f^Omega(p, q) f^R(A(p), A(q)) / sum_q w(q) f^Omega f^R,
/// f^Omega a Gaussian of pyramid_sigma(edge.radius(A(p))), q over the square of 3 sigma around p
/// (radius + 1 pixels, rounded up). Sums in double. Costs the square of the radius.
template <typename Edge>
void bilateral_filter(const Edge& edge, const PyramidInputs& in, Planes<3>& out) {
  const Extent extent = in.weight.extent();
  const auto pixel = [&](int x, int y) {
    double sum[4] = {};
    const float* own = in.attributes.at(x, y);
    const bool exists = edge.exists(own);
    const float sigma = exists ? pyramid_sigma(edge.radius(own)) : 0.0f;
    const int reach = exists ? static_cast<int>(std::ceil(3.0f * sigma)) : -1;
    for (int qy = std::max(y - reach, 0); qy <= std::min(y + reach, extent.height - 1); ++qy) {
      for (int qx = std::max(x - reach, 0); qx <= std::min(x + reach, extent.width - 1); ++qx) {
        const float w = in.weight(qx, qy);
        const float* other = in.attributes.at(qx, qy);
        if (!(w > 0.0f) || !edge.exists(other)) continue;
        const auto d2 = static_cast<float>((qx - x) * (qx - x) + (qy - y) * (qy - y));
        const float energy = d2 == 0.0f ? 0.0f : edge.energy(own, other, d2);
        const auto total = static_cast<double>(w * std::exp(-energy - d2 / (2.0f * sigma * sigma)));
        for (std::size_t c = 0; c < 3; ++c) {
          sum[c] += total * static_cast<double>(in.signal[c](qx, qy));
        }
        sum[3] += total;
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      out[c](x, y) = sum[3] > 0.0 ? static_cast<float>(sum[c] / sum[3]) : 0.0f;
    }
  };
  for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) pixel(x, y);
    }
  });
}

}  // namespace eigenlight
