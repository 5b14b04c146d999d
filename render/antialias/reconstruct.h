// Subpixel reconstruction: light at a geometry sample from shaded neighbors.
#pragma once

#include <cstdint>
#include <optional>

#include "render/antialias/guide_map.h"

namespace eigenlight {

/// Light (direct + indirect, over albedo) at an eye ray's hit i from the guide rays j around it:
///   light = sum_j w_ij light_j / sum_j w_ij,
///   w_ij = G(sigma_z dz) G(sigma_n dn) [lit_i = lit_j],  G(x) = exp(-x^2)
///   dz = z_j - z_i,  dn = 1 - clamp(n_j . n_i, 0, 1)
/// (Chiu, Chen, Chang, Lee 2012, Eq. 1; the last factor is what they say of Eq. 2: a neighbor on
/// the other side of a shadow's edge is left out.) `lit` is PathTracer::lit_by() at each guide ray,
/// `eye_lit` at the eye ray's hit.
///
/// Guide rays whose pixel centers are farther than kReconstructRadius pixels, that met no surface
/// that reflects, or whose light is not finite are left out. Nothing if the weights of those that
/// are left add up to less than kLeastWeight: no neighbor is like this point.
[[nodiscard]] std::optional<glm::vec3> reconstruct_light(const GuideMap& guides,
                                                         const Plane<std::uint8_t>& lit,
                                                         const EyePoint& eye, std::uint8_t eye_lit);

/// Chiu 2012, 3.1. Per unit of the scene, which is a meter in ours.
inline constexpr float kSigmaZ = 10.0f;
/// One over Chiu's 0.25: as the factor that Eq. 1 prints, 0.25 leaves perpendicular walls a weight
/// of 0.94. Figures of both: docs/experiments/2026-11-antialiasing.md.
inline constexpr float kSigmaN = 4.0f;
/// Pixels. Three or four guide rays, the own among them; figures in docs/experiments.
inline constexpr float kReconstructRadius = 1.0f;
/// What a lone neighbor 0.17 m behind weighs: one less alike counts as none. Taste.
inline constexpr float kLeastWeight = 0.05f;

}  // namespace eigenlight
