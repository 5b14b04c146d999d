// Range functions of the pyramid filter in double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "frame/frame.h"
#include "spatial/rivals/pyramid.h"

namespace eigenlight::reference {

/// Range function f^R at a distance in pixels, which pixels exist, and how attributes are averaged.
template <std::size_t N>
struct Range {
  std::function<double(const std::array<double, N>&, const std::array<double, N>&, double)> value;
  std::function<bool(const std::array<double, N>&)> exists;
  std::function<double(const std::array<double, N>&)> radius;
  bool keeps_major = true;
  double gamma = 1.0;  // times that of a pass
};

/// Eq. 9 for diffuse light, z in units of z_p.
inline Range<4> global_illumination_range(const GlobalIlluminationEdge& edge) {
  using A = std::array<double, 4>;
  return {[edge](const A& p, const A& q, double) {
            const double cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            return std::pow(std::clamp(cosine, 0.0, 1.0), static_cast<double>(edge.normal_power)) *
                   std::exp(-static_cast<double>(edge.depth_scale) * std::abs(p[3] - q[3]) / p[3]);
          },
          [](const A& a) { return a[3] > 0.0; },
          [edge](const A&) { return static_cast<double>(edge.blur_radius); }, true,
          static_cast<double>(edge.gamma_scale)};
}

/// Eq. 9 for reflections.
inline Range<5> reflection_range(const ReflectionEdge& edge) {
  using A = std::array<double, 5>;
  const Range<4> geometry = global_illumination_range(edge.geometry);
  const auto head = [](const A& a) { return std::array<double, 4>{a[0], a[1], a[2], a[3]}; };
  return {[=](const A& p, const A& q, double d) {
            const double t = std::min(std::abs(p[4] - q[4]) / 0.5, 1.0);
            return geometry.value(head(p), head(q), d) * (1.0 - t * t * (3.0 - 2.0 * t));
          },
          [](const A& a) { return a[3] > 0.0; },
          [edge](const A& a) { return static_cast<double>(edge.geometry.blur_radius) * a[4]; },
          true, static_cast<double>(edge.geometry.gamma_scale)};
}

/// Attributes of GlobalIlluminationEdge: 0 where no surface counts.
inline Plane<float> surface_attributes(const GBuffer& surface) {
  Plane<float> attributes(surface.depth.extent(), 4);
  for (int y = 0; y < attributes.height(); ++y) {
    for (int x = 0; x < attributes.width(); ++x) {
      const float own[4] = {surface.normal[0](x, y), surface.normal[1](x, y),
                            surface.normal[2](x, y), surface.depth(x, y)};
      const bool finite = std::all_of(own, own + 4, [](float v) { return std::isfinite(v); });
      if (surface.id(x, y) != 0 && finite && own[3] > 0.0f) {
        std::copy_n(own, 4, attributes.at(x, y));
      }
    }
  }
  return attributes;
}

/// Eq. 8.
inline Range<1> depth_of_field_range(const DepthOfFieldEdge& edge) {
  using A = std::array<double, 1>;
  const double sigma = static_cast<double>(edge.sigma);
  return {[](const A& p, const A& q, double d) {
            const double circle = std::max(std::min(p[0], q[0]), 1e-3);
            return std::exp(-18.0 * d * d / (circle * circle));
          },
          [](const A&) { return true; },
          [sigma](const A& a) {
            const double circle = std::max(a[0], 1e-3);
            const double variance = 1.0 / (36.0 / (circle * circle) + 1.0 / (sigma * sigma));
            return std::max(3.0 * std::sqrt(variance) - 1.0, 0.0);
          },
          false};
}

/// Eq. 10.
inline Range<1> particle_range(const ParticleEdge& edge) {
  using A = std::array<double, 1>;
  return {[edge](const A& p, const A& q, double) {
            return std::exp(-static_cast<double>(edge.depth_scale) * p[0] * std::abs(p[0] - q[0]));
          },
          [](const A& a) { return a[0] > 0.0 && std::isfinite(a[0]); },
          [edge](const A&) { return static_cast<double>(edge.blur_radius); }, true,
          static_cast<double>(edge.gamma_scale)};
}

}  // namespace eigenlight::reference
