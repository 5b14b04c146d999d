// The filter that the pyramid approximates, by brute force: what training and measurements aim at.
#pragma once

#include <algorithm>
#include <cmath>

#include "spatial/rivals/pyramid.h"

namespace eigenlight {
namespace bilateral_detail {

// Eq. 1 at (x, y) over the offsets in x and y up to 3 sigma times `span`.
template <typename Edge>
void filter_pixel(const Edge& edge, const PyramidInputs& in, Extent span, int x, int y,
                  Planes<3>& out) {
  const Extent extent = in.weight.extent();
  double sum[4] = {};
  const float* own = in.attributes.at(x, y);
  const bool exists = edge.exists(own);
  const float sigma = exists ? pyramid_sigma(edge.radius(own)) : 0.0f;
  const int reach = exists ? static_cast<int>(std::ceil(3.0f * sigma)) : -1;
  const int rx = reach * span.width, ry = reach * span.height;
  for (int qy = std::max(y - ry, 0); qy <= std::min(y + ry, extent.height - 1) && exists; ++qy) {
    for (int qx = std::max(x - rx, 0); qx <= std::min(x + rx, extent.width - 1); ++qx) {
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
}

template <typename Edge>
void filter_image(const Edge& edge, const PyramidInputs& in, Extent span, Planes<3>& out) {
  for_each_tile(stage_tiles(in.weight.extent()), [&](const Rect& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) filter_pixel(edge, in, span, x, y, out);
    }
  });
}

}  // namespace bilateral_detail

/// Xu et al. 2024, Eq. 1, with weights:
///   out(p) = sum_q I(q) w(q) f^Omega(p, q) f^R(A(p), A(q)) / sum_q w(q) f^Omega f^R,
/// f^Omega a Gaussian of pyramid_sigma(edge.radius(A(p))), q over the square of 3 sigma around p
/// (radius + 1 pixels, rounded up). Sums in double. Costs the square of the radius.
template <typename Edge>
void bilateral_filter(const Edge& edge, const PyramidInputs& in, Planes<3>& out) {
  bilateral_detail::filter_image(edge, in, {1, 1}, out);
}

/// The same in two passes, along rows and then along columns, each normalized: what stands for it
/// where time is short, though the range function is not separable. Costs the radius.
template <typename Edge>
void separable_bilateral_filter(const Edge& edge, const PyramidInputs& in, Planes<3>& out) {
  Planes<3> rows = make_planes<3>(in.weight.extent());
  bilateral_detail::filter_image(edge, in, {1, 0}, rows);
  bilateral_detail::filter_image(edge, {in.attributes, rows, in.weight}, {0, 1}, out);
}

}  // namespace eigenlight
