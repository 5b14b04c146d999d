// The first hit of the guide ray through each pixel center.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "render/paths/path_tracer.h"

namespace eigenlight {

/// What a guide ray met. Surfaces that reflect have `point`; lights and the sky do not.
struct GuideHit {
  enum class Kind : std::uint8_t { kSky, kShape, kSurface };
  Kind kind = Kind::kSky;
  SurfacePoint point;
};

/// What a ray from the eye meets: all of a point of the picture but the light that arrives there.
struct EyeHit {
  GuideHit guide;
  float depth = std::numeric_limits<float>::infinity();  ///< along the view axis
  glm::vec3 direction{0.0f};                             ///< of the ray, unit
  glm::vec3 position{0.0f}, normal{0.0f}, albedo{0.0f};  ///< as in GBuffer; 0 without surface
  glm::vec3 emission{0.0f};                              ///< of the sky too
  Hit hit;                                               ///< of kSurface
  ShapeHit shape;                                        ///< of kShape
};

/// The ray through `pixel` (in pixel coordinates, not only centers). Textures are read as a cone of
/// `spread` radians sees them; 1 / camera.focal is a pixel's. Thin glass is not seen.
[[nodiscard]] EyeHit trace_eye(const World& world, const Camera& camera, const glm::vec2& pixel,
                               float spread);

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
std::int64_t trace_guides(const World& world, const PreviousView& previous, const Rect& tile,
                          Frame& frame, Plane<GuideHit>& hits);

/// Pixels, in x and y: outside every image.
inline constexpr float kUnseenMotion = -4.0f * kMaxSide;

}  // namespace eigenlight
