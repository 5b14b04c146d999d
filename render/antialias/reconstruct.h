// Subpixel reconstruction: light at an additional camera ray from the guide rays around it.
#pragma once

#include <cstdint>
#include <optional>

#include "render/antialias/guide_map.h"

namespace eigenlight {

/// Light (direct + indirect, divided by albedo) at the hit i of a camera ray, from guide rays j:
///   light = sum_j w_ij light_j / sum_j w_ij,
///   w_ij = G(sigma_z dz) G(sigma_n dn) [lit_i = lit_j],  G(x) = exp(-x^2)
///   dz = z_j - z_i,  dn = 1 - clamp(n_j . n_i, 0, 1)
/// (Chiu, Chen, Chang, Lee 2012, Eq. 1. The last factor follows their description of Eq. 2, which
/// leaves out neighbors on the other side of a shadow edge.) `lit` is PathTracer::lit_by() at each
/// guide ray, `eye_lit` the same at the camera ray.
///
/// Guide rays are left out if their pixel center is farther than kReconstructRadius, if they met no
/// reflecting surface, or if their light is not finite. Returns nullopt if the remaining weights
/// add up to less than kLeastWeight: no neighbor is similar.
[[nodiscard]] std::optional<glm::vec3> reconstruct_light(const GuideMap& guides,
                                                         const Plane<std::uint8_t>& lit,
                                                         const EyePoint& eye, std::uint8_t eye_lit);

/// Per scene unit, a meter in our scenes (Chiu 2012, 3.1).
inline constexpr float kSigmaZ = 10.0f;
/// 1 / 0.25. Chiu 2012 prints 0.25, which as a factor would give perpendicular walls a weight of
/// 0.94. Both are compared in docs/experiments/2026-11-antialiasing.md.
inline constexpr float kSigmaN = 4.0f;
/// Pixels; covers three or four guide rays, including that of the pixel itself.
inline constexpr float kReconstructRadius = 1.0f;
/// The weight of a single neighbor at a depth difference of 0.17 m. Chosen by eye.
inline constexpr float kLeastWeight = 0.05f;

}  // namespace eigenlight
