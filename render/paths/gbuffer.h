// G-buffer: the first hit of the guide ray through each pixel center.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "render/paths/path_tracer.h"

namespace eigenlight {

/// First hit of a guide ray. Only kSurface, a reflecting surface, fills `point`.
struct GuideHit {
  enum class Kind : std::uint8_t { kSky, kShape, kSurface };  // kShape: a light shape
  Kind kind = Kind::kSky;
  SurfacePoint point;
};

/// First hit of a camera ray: everything but the light that arrives there.
struct EyeHit {
  GuideHit guide;
  float depth = std::numeric_limits<float>::infinity();  ///< along the view axis
  glm::vec3 direction{0.0f};                             ///< unit direction of the ray
  glm::vec3 position{0.0f}, normal{0.0f}, albedo{0.0f};  ///< as in GBuffer; 0 without surface
  glm::vec3 emission{0.0f};                              ///< of surface, light shape or sky
  Hit hit;                                               ///< valid for kSurface
  ShapeHit shape;                                        ///< valid for kShape
};

/// Traces the camera ray through the point `pixel` in pixel coordinates. Textures are filtered over
/// a cone of `spread` radians; one pixel has 1 / camera.focal. Thin glass is ignored.
[[nodiscard]] EyeHit trace_eye(const World& world, const Camera& camera, const glm::vec2& pixel,
                               float spread);

/// The scene of the frame that motion vectors lead to.
struct PreviousView {
  Camera camera;
  Lights lights;                     ///< for the motion of light shapes
  std::span<const glm::mat4> poses;  ///< world transforms of all instances
};

/// Traces the guide rays of `tile` from frame.camera. Fills `hits` and the planes depth, normal,
/// albedo, id, position, emission, motion and previous_depth of `frame`. All planes must have the
/// size of the frame. Returns the number of rays.
///
/// The id of an instance is its index + 1; light shapes follow. Thin glass is ignored. Motion is
/// exact: it leads to the same point of the triangle or light shape under the previous pose and
/// camera, for the sky to the same direction. A point that was not in front of the previous camera
/// gets kUnseenMotion; its previous_depth is then not positive.
std::int64_t trace_guides(const World& world, const PreviousView& previous, const Rect& tile,
                          Frame& frame, Plane<GuideHit>& hits);

/// Motion in pixels, in x and y, that leads out of every image.
inline constexpr float kUnseenMotion = -4.0f * kMaxSide;

}  // namespace eigenlight
