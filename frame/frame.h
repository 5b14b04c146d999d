// What a frame is, and where frames come from. Units, axes and signs: frame/README.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

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

/// One layer of light as it was rendered: noisy, and without the color that a picture multiplies it
/// by, so that filters do not blur textures.
struct NoisyLight {
  Planes<3> radiance;  ///< over `color`, linear Rec. 709; may hold NaN and Inf
  Planes<3> color;     ///< what a picture multiplies it by; empty: the albedo of the surface
  /// Direct light: its edges are sharp, move over surfaces and are in no guide.
  bool is_direct = false;
  /// Reflections and what is seen through glass: it moves otherwise than the surface.
  bool is_glossy = false;
};

/// Most layers of light that a frame holds. Each has its own history: memory and time grow with
/// their number.
inline constexpr int kMaxLights = 32;

/// All that the denoiser reads of a frame. The source fills it; every stage only reads it. Planes
/// may be views of the source's memory (Plane::view), valid until the next frame is asked for.
struct FrameInput {
  int index = 0;            ///< frame number
  int previous_index = -1;  ///< frame that `motion` leads to; history of any other frame is dropped
  /// The source knows that camera and objects stand as in the previous frame.
  bool is_static = false;
  int spp = 0;  ///< samples per pixel in each layer of light
  Camera camera;
  GBuffer surface;
  std::vector<NoisyLight> lights = std::vector<NoisyLight>(1);  ///< one to kMaxLights layers
  Planes<2> motion;  ///< pixels: what is seen at p was at p + motion(p) in the previous frame
  Plane<float> previous_depth;  ///< depth that the same point had there, for that frame's camera
  /// Mean over the samples of a pixel, shorter than 1 where they differ; empty: guides have no
  /// noise.
  Planes<3> mean_normal;

  std::int64_t rays = 0;                ///< traced for this frame so far, resampling included
  std::int64_t non_finite_samples = 0;  ///< samples the source itself excluded

  [[nodiscard]] Extent extent() const { return surface.depth.extent(); }

  /// Gives all planes the shape `extent` but the lights' colors; keeps those that have it already.
  void resize_input(Extent extent) {
    surface.resize(extent);
    for (NoisyLight& light : lights) ensure_extent(light.radiance, extent);
    ensure_extent(motion, extent);
    ensure_extent(previous_depth, extent);
  }
};

/// A frame with the layers that pass the denoiser by: they are composed and written.
struct Frame : FrameInput {
  Planes<3> direct;    ///< radiance over albedo that lights send to the first hit
  Planes<3> emission;  ///< radiance that the first hit, or the sky behind it, sends out itself
  Planes<3> position;  ///< world space; 0 where there is no surface

  /// resize_input(), and the same for the other layers.
  void resize(Extent extent) {
    resize_input(extent);
    ensure_extent(direct, extent);
    ensure_extent(emission, extent);
    ensure_extent(position, extent);
  }
};

/// Copies all that the denoiser reads of a frame but its layers of light, which stay as they are in
/// `to`, reusing its storage. Planes that are empty in `from` become empty.
void copy_all_but_lights(const FrameInput& from, FrameInput& to);

/// Copies all of a frame, reusing the storage of `to`. Planes that are empty in `from` become
/// empty.
void copy_frame(const Frame& from, Frame& to);

/// Where frames come from: our renderer, or files.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Fills `frame` with the next frame, reusing its storage. False at the end of the sequence.
  [[nodiscard]] virtual bool next(Frame& frame) = 0;

  /// Draws extra(p) further samples of light at each pixel p of the frame that next() delivered
  /// last, independent of those it holds, and writes their mean to `means`, one for each layer of
  /// light (0 where extra(p) is 0). Adds to frame.rays and frame.non_finite_samples, and changes
  /// nothing else of `frame`. False, with `means` untouched, when the source has no more samples to
  /// give (files).
  [[nodiscard]] virtual bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                                      std::span<Planes<3>* const> means) = 0;
};

/// FrameSource::resample() of a frame with one layer of light.
[[nodiscard]] inline bool resample(FrameSource& source, const Plane<std::uint8_t>& extra,
                                   FrameInput& frame, Planes<3>& mean) {
  Planes<3>* const means[] = {&mean};
  return source.resample(extra, frame, means);
}

}  // namespace eigenlight
