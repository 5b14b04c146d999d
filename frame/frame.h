// What a frame is, and where frames come from. Units, axes and signs: frame/README.md.
#pragma once

#include <cstdint>

#include "frame/camera.h"
#include "frame/plane.h"

namespace eigenlight {

/// First hit of the guide ray through each pixel center. Noise-free: no antialiasing, no blur.
struct GBuffer {
  Plane<float> depth;       ///< along the view axis, > 0; +inf where there is no surface
  Planes<3> normal;         ///< unit, world space, facing the camera; 0 where there is no surface
  Planes<3> albedo;         ///< [0, 1], linear Rec. 709
  Plane<std::uint32_t> id;  ///< object; 0 where there is no surface

  void resize(Extent extent) {
    ensure_extent(depth, extent);
    ensure_extent(normal, extent);
    ensure_extent(albedo, extent);
    ensure_extent(id, extent);
  }
};

/// Everything that a source knows of one frame. The source fills it; every stage only reads it.
struct Frame {
  int index = 0;            ///< frame number
  int previous_index = -1;  ///< frame that `motion` leads to; history of any other frame is dropped
  bool is_static =
      false;    ///< the source knows that camera and objects stand as in the previous frame
  int spp = 0;  ///< samples of indirect light per pixel in `indirect`
  Camera camera;
  GBuffer surface;
  Planes<3> indirect;  ///< raw indirect radiance over albedo, linear; may hold NaN and Inf
  Planes<2> motion;    ///< pixels: what is seen at p was at p + motion(p) in the previous frame
  Plane<float> previous_depth;  ///< depth that the same point had there, for that frame's camera

  // Layers that the denoiser passes by: they are composed and written.
  Planes<3> direct;    ///< radiance over albedo that lights send to the first hit
  Planes<3> emission;  ///< radiance that the first hit, or the sky behind it, sends out itself
  Planes<3> position;  ///< world space; 0 where there is no surface

  std::int64_t rays = 0;                ///< traced for this frame so far, resampling included
  std::int64_t non_finite_samples = 0;  ///< samples the source itself excluded

  [[nodiscard]] Extent extent() const { return surface.depth.extent(); }

  /// Allocates all planes for `extent`; keeps those that have it already.
  void resize(Extent extent) {
    surface.resize(extent);
    ensure_extent(indirect, extent);
    ensure_extent(motion, extent);
    ensure_extent(previous_depth, extent);
    ensure_extent(direct, extent);
    ensure_extent(emission, extent);
    ensure_extent(position, extent);
  }
};

/// Copies all of a frame, reusing the storage of `to`.
inline void copy_frame(const Frame& from, Frame& to) {
  // Names every member, so that one that is added later cannot be forgotten here.
  const auto& [number, previous, still, samples, camera, surface, indirect, motion, previous_depth,
               direct, emission, position, rays, non_finite] = from;
  const auto& [depth, normal, albedo, id] = surface;
  to.resize(from.extent());
  to.index = number;
  to.previous_index = previous;
  to.is_static = still;
  to.spp = samples;
  to.camera = camera;
  to.surface.depth.copy_from(depth);
  copy_planes(normal, to.surface.normal);
  copy_planes(albedo, to.surface.albedo);
  to.surface.id.copy_from(id);
  copy_planes(indirect, to.indirect);
  copy_planes(motion, to.motion);
  to.previous_depth.copy_from(previous_depth);
  copy_planes(direct, to.direct);
  copy_planes(emission, to.emission);
  copy_planes(position, to.position);
  to.rays = rays;
  to.non_finite_samples = non_finite;
}

/// Where frames come from: our renderer, or files.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Fills `frame` with the next frame, reusing its storage. False at the end of the sequence.
  [[nodiscard]] virtual bool next(Frame& frame) = 0;

  /// Draws extra(p) further samples of indirect light at each pixel p of the frame that next()
  /// delivered last, independent of those it holds, and writes their mean to `mean` (0 where
  /// extra(p) is 0). Adds to frame.rays and frame.non_finite_samples, and changes nothing else of
  /// `frame`. False, with `mean` untouched, when the source has no more samples to give (files).
  [[nodiscard]] virtual bool resample(const Plane<std::uint8_t>& extra, Frame& frame,
                                      Planes<3>& mean) = 0;
};

}  // namespace eigenlight
