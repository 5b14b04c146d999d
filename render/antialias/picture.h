// The antialiased picture of a frame.
#pragma once

#include <cstdint>

#include "render/antialias/guide_map.h"
#include "render/antialias/options.h"
#include "render/paths/path_tracer.h"

namespace eigenlight {

struct PictureStats {
  std::int64_t rays = 0;
  std::int64_t non_finite = 0;  ///< samples left out of the means
  std::int64_t unmatched = 0;   ///< camera rays without a similar guide ray: path-traced
};

/// Inputs of render_picture().
struct PictureInputs {
  const World& world;
  const PathTracer& tracer;
  const GuideMap& guides;
  int spp = 1;         ///< samples of indirect light per camera ray, where it is path-traced
  int direct_spp = 1;  ///< samples of direct light that each guide ray had
  std::uint32_t seed = 0;
  /// The part of guides.direct that comes from suns, where that is denoised and without noise;
  /// null: light at camera rays is path-traced.
  const Planes<3>* sun = nullptr;
};

/// Renders the picture of a frame in linear radiance without clamping. A pixel is the mean of
/// albedo * (direct + indirect) + emission over its camera rays:
///   kLookup       the guide ray and four rays of a rotated grid. Grid rays take indirect light
///   from
///                 most_similar_guide(), and path-trace direct light with a quarter of direct_spp.
///                 With `sun` they take that from there too, but for light of suns, which is that
///                 of the most similar guide ray on their side of the shadow's edge: a shadow ray
///                 to the middle of a sun says which side that is.
///   kSraa         the same rays. Grid rays take all light from reconstruct_light().
///   kSraaGeometry kSraa without shadow rays, so that light is mixed across shadow edges.
///   kSupersample  `samples` jittered rays without the guide ray. Each path-traces spp and
///                 direct_spp samples, so denoised light is not used.
/// Where lookup or reconstruction finds no guide ray, the light is path-traced and `unmatched`
/// counts the ray. Lamps and sky show the emission that the camera ray itself meets. Camera rays of
/// non-finite color are left out of the mean and counted; a pixel without a finite ray is NaN.
///
/// `out` gets the size of the frame. Bits depend on the frame, its light and the seed, not
/// on the number of threads. Throws std::invalid_argument on kNone, on a number of samples out of
/// range, or if planes differ in size.
PictureStats render_picture(const AntialiasOptions& options, const PictureInputs& in,
                            Planes<3>& out);

}  // namespace eigenlight
