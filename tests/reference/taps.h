// Twin of reproject/taps: one pixel, in double, from the formula in the header.
#pragma once

#include <array>
#include <cmath>

#include "reproject/taps.h"

namespace eigenlight::reference {

struct Taps {
  double weight[4] = {};
  /// How far the nearest decision was from falling the other way, in its own units. Where it is
  /// below float noise, float and double may disagree.
  double margin = 1.0;
};

/// Weights of valid taps that sum to less than this are dropped; the kernel's rule.
inline constexpr double kLeastWeight = 0.01;

namespace detail {

inline glm::dvec3 normal_at(const GBuffer& surface, int x, int y) {
  return {surface.normal[0](x, y), surface.normal[1](x, y), surface.normal[2](x, y)};
}

// World position of pixel coordinates at a depth.
inline glm::dvec3 position(const Camera& camera, glm::dvec2 pixel, double depth) {
  const glm::dvec3 view((pixel - glm::dvec2(camera.center)) / static_cast<double>(camera.focal),
                        1.0);
  return glm::transpose(glm::dmat3(camera.world_to_view)) * (view * depth) + glm::dvec3(camera.eye);
}

}  // namespace detail

/// Taps of pixel (x, y). The pixel's place in the previous frame is rounded to float, as pixel
/// coordinates are.
inline Taps taps(const FrameInput& current, const PreviousSurface& previous,
                 const TapOptions& options, glm::ivec2 p) {
  Taps out;
  const Extent extent = previous.surface.depth.extent();
  const float column = static_cast<float>(p.x) + current.motion[0](p.x, p.y);
  const float line = static_cast<float>(p.y) + current.motion[1](p.x, p.y);
  const double depth = current.previous_depth(p.x, p.y);
  if (current.surface.id(p.x, p.y) == 0 || !std::isfinite(column) || !std::isfinite(line) ||
      !std::isfinite(depth) || depth <= 0.0) {
    return out;
  }
  const glm::dvec2 q(column, line);
  const glm::dvec3 normal = detail::normal_at(current.surface, p.x, p.y);
  const glm::dvec3 here = detail::position(previous.camera, q + 0.5, depth);
  double sum = 0.0;
  for (int t = 0; t < 4; ++t) {
    const double x = std::floor(q.x) + t % 2, y = std::floor(q.y) + t / 2;
    if (x < 0 || y < 0 || x >= extent.width || y >= extent.height) continue;
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    if (previous.surface.id(ix, iy) != current.surface.id(p.x, p.y)) continue;
    const glm::dvec3 there = detail::position(previous.camera, glm::dvec2(ix + 0.5, iy + 0.5),
                                              previous.surface.depth(ix, iy));
    const double distance = std::abs(glm::dot(normal, there - here));
    const double cosine = glm::dot(normal, detail::normal_at(previous.surface, ix, iy));
    const double bound = options.plane_distance * depth;
    out.margin = std::min(
        {out.margin, std::abs(distance - bound) / depth, std::abs(cosine - options.normal_cosine)});
    if (distance > bound || cosine < options.normal_cosine) continue;
    out.weight[t] = (1.0 - std::abs(q.x - x)) * (1.0 - std::abs(q.y - y));
    sum += out.weight[t];
  }
  out.margin = std::min(out.margin, std::abs(sum - kLeastWeight));
  for (double& w : out.weight) w = sum >= kLeastWeight ? w / sum : 0.0;
  return out;
}

}  // namespace eigenlight::reference
