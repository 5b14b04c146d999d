// Edge-stopping functions for the pyramid filter.
//
// An edge type says what a pixel's attributes A are, how alike two pixels are, and how wide the
// domain function is:
//   kAttributes          values of a pixel, side by side
//   kKeepsMajor          true: a coarser pixel has the attributes of its major pixel (Xu et al.
//                        2024, section 3.2); false: their weighted mean, as in Eq. 3
//   exists(a)            false: the pixel neither gives nor takes
//   energy(p, q, d2)     -ln f^R(A(p), A(q)) in [0, inf], d2 the squared distance in pixels of the
//                        image; of two pixels that exist
//   radius(a)            of the Gaussian domain function there, pixels; pyramid_sigma() of it is
//                        the standard deviation
//   gamma()              [0, 1], times the table's gamma: how much finer samples stand in for
//   coarser
//                        ones beyond an edge. "Solved by tuning", section 3.3.1, for each use
// An energy rather than f^R, so that a power of f^R is a product.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/check.h"

namespace eigenlight {

/// Eq. 9 without roughness: global illumination on diffuse surfaces. Attributes: unit normal, depth
/// (0: no surface). (N_p . N_q)^sigma_N exp(-sigma_z |z_p - z_q| / z_p): depths are in units of the
/// center's, z_p = 1 in the paper's formula, so that the scale of the scene does not matter.
struct GlobalIlluminationEdge {
  static constexpr int kAttributes = 4;
  static constexpr bool kKeepsMajor = true;

  float normal_power = 32.0f;  ///< [8, 1000] sigma_N
  float depth_scale = 16.0f;   ///< [0, 1000] sigma_z
  float blur_radius = 16.0f;   ///< [0, 64] pixels
  /// [0, 1] of the table's gamma; 0 for diffuse light, as in section 5.1: noise is worse than blur.
  float gamma_scale = 0.0f;

  void validate() const {
    EL_CHECK(normal_power >= 8.0f && normal_power <= 1000.0f, "normal_power {}: expected [8, 1000]",
             normal_power);
    EL_CHECK(depth_scale >= 0.0f && depth_scale <= 1000.0f, "depth_scale {}: expected [0, 1000]",
             depth_scale);
    EL_CHECK(blur_radius >= 0.0f && blur_radius <= 64.0f, "radius {}: expected [0, 64] pixels",
             blur_radius);
    EL_CHECK(gamma_scale >= 0.0f && gamma_scale <= 1.0f, "gamma_scale {}: expected [0, 1]",
             gamma_scale);
  }
  [[nodiscard]] static bool exists(const float* a) { return a[3] > 0.0f; }
  [[nodiscard]] float energy(const float* p, const float* q, float) const {
    const float cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    if (!(cosine > 0.0f)) return std::numeric_limits<float>::infinity();
    const float bend = cosine < 1.0f ? -normal_power * std::log(cosine) : 0.0f;
    return bend + depth_scale * std::abs(p[3] - q[3]) / p[3];
  }
  [[nodiscard]] float radius(const float*) const { return blur_radius; }
  [[nodiscard]] float gamma() const { return gamma_scale; }
};

/// Eq. 9 with roughness: glossy reflections. A fifth attribute, sqrt(alpha) in [0, 1], widens the
/// domain function and stops at 1 - smoothstep(0, 0.5, |difference|). (The paper prints smoothstep
/// itself, which would keep what differs and drop what is alike.)
struct ReflectionEdge {
  static constexpr int kAttributes = 5;
  static constexpr bool kKeepsMajor = true;

  /// blur_radius is sigma_alpha, the radius at roughness 1. The paper's untrained filter has
  /// gamma 1.
  GlobalIlluminationEdge geometry{.gamma_scale = 0.15f};

  [[nodiscard]] static bool exists(const float* a) { return a[3] > 0.0f; }
  [[nodiscard]] float energy(const float* p, const float* q, float d2) const {
    const float t = std::min(std::abs(p[4] - q[4]) / 0.5f, 1.0f);
    const float alike = 1.0f - t * t * (3.0f - 2.0f * t);
    if (!(alike > 0.0f)) return std::numeric_limits<float>::infinity();
    return geometry.energy(p, q, d2) - std::log(alike);
  }
  [[nodiscard]] float radius(const float* a) const { return geometry.blur_radius * a[4]; }
  [[nodiscard]] float gamma() const { return geometry.gamma_scale; }
};

/// Eq. 8: depth of field. Attribute: diameter of the circle of confusion in pixels, >= 0. The
/// domain function exp(-18 d^2 / A_p^2 - d^2 / (2 sigma^2)) narrows with the circle; the range
/// function exp(-18 d^2 / min(A_p, A_q)^2) keeps the sharper of two pixels out of the other.
struct DepthOfFieldEdge {
  static constexpr int kAttributes = 1;
  static constexpr bool kKeepsMajor = false;

  float sigma = 16.0f;  ///< (0, 21] pixels: bound on the blur

  [[nodiscard]] static bool exists(const float*) { return true; }
  [[nodiscard]] float energy(const float* p, const float* q, float d2) const {
    // A thousandth of a pixel: in focus, and no division by zero.
    const float circle = std::max(std::min(p[0], q[0]), 1e-3f);
    return 18.0f * d2 / (circle * circle);
  }
  [[nodiscard]] float radius(const float* a) const {
    const float circle = std::max(a[0], 1e-3f);
    const float narrowed = 1.0f / std::sqrt(36.0f / (circle * circle) + 1.0f / (sigma * sigma));
    return std::max(3.0f * narrowed - 1.0f, 0.0f);
  }
  [[nodiscard]] static float gamma() { return 1.0f; }
};

/// Eq. 10: depth of particles. Attribute: depth (not > 0 or not finite: no particle).
/// exp(-sigma_z z_p |z_p - z_q|).
struct ParticleEdge {
  static constexpr int kAttributes = 1;
  static constexpr bool kKeepsMajor = true;

  float depth_scale = 1.0f;   ///< >= 0, one over squared units of depth
  float blur_radius = 16.0f;  ///< [0, 64] pixels
  float gamma_scale = 0.4f;   ///< [0, 1]; the paper's untrained filter has 1

  [[nodiscard]] static bool exists(const float* a) { return a[0] > 0.0f && std::isfinite(a[0]); }
  [[nodiscard]] float energy(const float* p, const float* q, float) const {
    return depth_scale * p[0] * std::abs(p[0] - q[0]);
  }
  [[nodiscard]] float radius(const float*) const { return blur_radius; }
  [[nodiscard]] float gamma() const { return gamma_scale; }
};

/// Colors as their own guide, exp(-|A_p - A_q|^2 / (2 sigma_r^2)): what section 3.3.2 trains on.
struct ColorEdge {
  static constexpr int kAttributes = 3;
  static constexpr bool kKeepsMajor = false;

  float color_sigma = 0.1f;   ///< > 0
  float blur_radius = 16.0f;  ///< [0, 64] pixels

  [[nodiscard]] static bool exists(const float*) { return true; }
  [[nodiscard]] float energy(const float* p, const float* q, float) const {
    const float d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    return (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / (2.0f * color_sigma * color_sigma);
  }
  [[nodiscard]] float radius(const float*) const { return blur_radius; }
  [[nodiscard]] static float gamma() { return 1.0f; }
};

}  // namespace eigenlight
