// The first hit of the guide ray through each pixel center.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "render/path_tracer.h"

namespace eigenlight {

/// What a guide ray met. Surfaces that reflect have `point`; lights and the sky do not.
struct GuideHit {
  enum class Kind : std::uint8_t { kSky, kShape, kSurface };
  Kind kind = Kind::kSky;
  SurfacePoint point;
};

/// The frame that motion leads to.
struct PreviousView {
  Camera camera;
  Lights lights;                     ///< shapes move too
  std::span<const glm::mat4> poses;  ///< of all instances
};

/// Fills depth, normal, albedo, id, position, emission, motion and previous_depth of the pixels of
/// `tile` from rays of frame.camera, and `hits`. Ids: instance + 1, then the light shapes. Thin
/// glass is not seen. Motion is exact: the point of the same triangle (of the same light; of the
/// same direction, for the sky) under the previous pose and camera. A point that was not in front
/// of the previous camera gets kUnseenMotion and its previous_depth, which is then not positive.
/// Returns the number of rays. Planes of `frame` and `hits` must have the frame's size.
std::int64_t trace_guides(const World& world, const PreviousView& previous, const Tile& tile,
                          Frame& frame, Plane<GuideHit>& hits);

/// Pixels, in x and y: outside every image.
inline constexpr float kUnseenMotion = -4.0f * kMaxSide;

}  // namespace eigenlight
