// The inputs of Xu 2024: pictures and attributes for each use of the pyramid filter.
#pragma once

#include "sequences/lab/paper_scene.h"
#include "spatial/training/bilateral.h"

namespace eigenlight {

/// A picture in [0, 1] and the edge-stopping function of its use.
template <typename Edge>
struct PyramidUse {
  PyramidUse(const Edge& function, Extent extent)
      : edge(function),
        attributes(extent, Edge::kAttributes),
        signal(make_planes<3>(extent)),
        weight(extent) {}
  [[nodiscard]] PyramidInputs inputs() const { return {attributes, signal, weight}; }

  Edge edge;
  Plane<float> attributes;
  Planes<3> signal;
  Plane<float> weight;  ///< 1 where a pixel takes part
};

/// Radius of the domain function in all uses, pixels.
inline constexpr float kUseRadius = 16.0f;

/// x / (1 + L), L = r/4 + g/2 + b/4: compression of samples before the filter, as in the first
/// author's public renderer (RayTracedGGX, FilterCommon.hlsli). Non-finite values stay non-finite.
void compress(const Plane<float>& mask, Planes<3>& light);

/// Section 4.2: `light` (linear) on the diffuse surfaces of `frame`, times exposure, compressed.
[[nodiscard]] PyramidUse<GlobalIlluminationEdge> diffuse_use(const Frame& frame,
                                                             const Planes<3>& light,
                                                             float exposure);

/// Section 4.2: reflections of a painted environment with three lamps, one half vector of the GGX
/// distribution per pixel, compressed. The surfaces of `frame` alternate between rough and smooth
/// in cubes of the world, like the paper's checkerboard.
[[nodiscard]] PyramidUse<ReflectionEdge> reflection_use(const Frame& frame);

/// Section 4.1: the albedo of `frame` in a light from the camera, without noise like the paper's
/// rasterized picture; focus at the median depth.
[[nodiscard]] PyramidUse<DepthOfFieldEdge> depth_of_field_use(const Frame& frame);

/// Section 4.3: the depth of a cloud of spheres; each seed gives another cloud.
[[nodiscard]] PyramidUse<ParticleEdge> particle_use(Extent extent, std::uint32_t seed);

/// Spheres lit from the front, with normals from differences of their depth, as in the paper's
/// Fig. 11.
[[nodiscard]] Planes<3> lit_particles(const PyramidUse<ParticleEdge>& use, const Planes<3>& depth);

}  // namespace eigenlight
