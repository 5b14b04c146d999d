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

inline constexpr float kSigmaZ = 10.0f;            ///< Chiu 2012, 3.1; per unit of the scene
inline constexpr float kSigmaN = 0.25f;            ///< Chiu 2012, 3.1
inline constexpr float kReconstructRadius = 1.0f;  ///< pixels
inline constexpr float kLeastWeight = 0.05f;

}  // namespace eigenlight
