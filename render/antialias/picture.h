// The antialiased picture of a frame.
#pragma once

#include <cstdint>

#include "render/antialias/guide_map.h"
#include "render/antialias/options.h"
#include "render/paths/path_tracer.h"

namespace eigenlight {

struct PictureStats {
  std::int64_t rays = 0;
  std::int64_t non_finite = 0;  ///< samples left out
  std::int64_t unmatched = 0;   ///< eye rays that no guide ray could lend light to: path-traced
};

/// What a picture is made from.
struct PictureInputs {
  const World& world;
  const PathTracer& tracer;
  const GuideMap& guides;
  int spp = 1;         ///< samples of indirect light where it is path-traced, per eye ray
  int direct_spp = 1;  ///< samples of direct light of a guide ray
  std::uint32_t seed = 0;
};

/// Renders the picture of a frame. Radiance, linear, not clamped: the mean over a pixel's eye rays
/// of albedo * (direct + indirect) + emission at what they meet.
///   kLookup       the guide ray and four of a rotated grid; direct light is path-traced at each,
///                 with a quarter of direct_spp at the grid's; indirect light is that of
///                 most_similar_guide()
///   kSraa         the same rays; light is that of reconstruct_light()
///   kSraaGeometry the same without shadow rays: light from both sides of a shadow's edge
///   kSupersample  `samples` jittered rays, without the guide ray; spp and direct_spp at each, so
///                 that the filtered indirect light takes no part
/// Where the lookup or reconstruction finds nothing, that part of the light is path-traced there
/// (`unmatched`). Lights and the sky keep the emission that the eye ray itself meets. Eye rays
/// whose color is not finite are left out and counted; a pixel without any other is NaN.
///
/// `out` gets the shape of the frame. Bits depend on the frame, the indirect light and the seed
/// alone, not on threads. Throws std::invalid_argument on kNone, which has nothing to render, on a
/// bad count of samples, or if planes differ in size.
PictureStats render_picture(const AntialiasOptions& options, const PictureInputs& in,
                            Planes<3>& out);

}  // namespace eigenlight
