// Twin of one SVGF pass (temporal/baselines/svgf_filter): in double, from the formula in the
// header.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "temporal/baselines/svgf_filter.h"

namespace eigenlight::reference {

struct SvgfPixel {
  std::array<double, 3> color{};
  double variance = 0.0;
};

namespace detail {

inline double svgf_luminance(const SvgfImage& image, glm::ivec2 p) {
  const auto& c = image.color;
  return 0.2126 * c[0](p.x, p.y) + 0.7152 * c[1](p.x, p.y) + 0.0722 * c[2](p.x, p.y);
}

inline double svgf_smooth_variance(const SvgfImage& image, glm::ivec2 p) {
  const Extent extent = image.variance.extent();
  double sum = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = std::clamp(p.x + dx, 0, extent.width - 1);
      const int y = std::clamp(p.y + dy, 0, extent.height - 1);
      sum += (2 - std::abs(dx)) * (2 - std::abs(dy)) * static_cast<double>(image.variance(x, y));
    }
  }
  return sum / 16.0;
}

// The slope of depth along an offset, by the plane through the pixel: depths of two points of it.
inline glm::dvec2 svgf_slope(const FrameInput& guides, glm::ivec2 p) {
  const Camera& camera = guides.camera;
  const auto& n = guides.surface.normal;
  const glm::dvec3 normal =
      glm::dmat3(camera.world_to_view) * glm::dvec3(n[0](p.x, p.y), n[1](p.x, p.y), n[2](p.x, p.y));
  const auto ray = [&](glm::dvec2 pixel) {
    return glm::dvec3((pixel - glm::dvec2(camera.center)) / static_cast<double>(camera.focal), 1.0);
  };
  const glm::dvec2 here = glm::dvec2(p) + 0.5;
  const double depth = guides.surface.depth(p.x, p.y);
  const double plane = depth * glm::dot(normal, ray(here));
  constexpr double kStep = 1e-4;
  glm::dvec2 slope;
  for (int axis = 0; axis < 2; ++axis) {
    glm::dvec2 step(0.0);
    step[axis] = kStep;
    const double above = plane / glm::dot(normal, ray(here + step));
    const double below = plane / glm::dot(normal, ray(here - step));
    slope[axis] = (above - below) / (2.0 * kStep);
  }
  return slope;
}

}  // namespace detail

/// Pixel p of the pass.
inline SvgfPixel svgf_pass(const SvgfPass& pass, const SvgfImage& in, glm::ivec2 p) {
  const GBuffer& surface = pass.guides.surface;
  constexpr std::array<double, 5> kSpline{1 / 16.0, 1 / 4.0, 3 / 8.0, 1 / 4.0, 1 / 16.0};
  SvgfPixel out;
  if (!(pass.known(p.x, p.y) > 0.0f)) return out;
  const double depth = surface.depth(p.x, p.y), own = detail::svgf_luminance(in, p);
  const glm::dvec2 slope = detail::svgf_slope(pass.guides, p);
  const double tolerance =
      pass.weights.luminance_sigmas * std::sqrt(detail::svgf_smooth_variance(in, p)) +
      1e-4 * std::abs(own);
  double weights = 0.0;
  for (int j = -2; j <= 2; ++j) {
    for (int i = -2; i <= 2; ++i) {
      const glm::ivec2 offset = pass.step * glm::ivec2(i, j), q = p + offset;
      if (!in.variance.extent().contains(q.x, q.y) || !(pass.known(q.x, q.y) > 0.0f)) continue;
      double cosine = 0.0;
      for (const auto& n : surface.normal) {
        cosine += static_cast<double>(n(p.x, p.y)) * static_cast<double>(n(q.x, q.y));
      }
      const double apart = std::abs(static_cast<double>(surface.depth(q.x, q.y)) - depth);
      const double expected =
          pass.weights.depth_slopes * std::abs(glm::dot(slope, glm::dvec2(offset)));
      const double light = std::abs(detail::svgf_luminance(in, q) - own);
      double w =
          kSpline[static_cast<std::size_t>(i + 2)] * kSpline[static_cast<std::size_t>(j + 2)];
      if (offset != glm::ivec2(0)) {
        w *= std::pow(std::max(cosine, 0.0), std::exp2(pass.weights.normal_squarings)) *
             std::exp(-apart / (expected + 1e-3 * depth) - (light > 0.0 ? light / tolerance : 0.0));
      }
      weights += w;
      for (std::size_t c = 0; c < 3; ++c) out.color[c] += w * in.color[c](q.x, q.y);
      out.variance += w * w * in.variance(q.x, q.y);
    }
  }
  for (double& c : out.color) c /= weights;
  out.variance /= weights * weights;
  return out;
}

}  // namespace eigenlight::reference
