// A FrameSource that path-traces an animated scene.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "frame/frame.h"
#include "render/antialias/picture.h"
#include "render/scene/scene.h"

namespace eigenlight {

struct RenderOptions {
  Extent extent{640, 360};
  int spp = 3;  ///< [1, 65536] samples of indirect light per pixel
  /// [0, 65536] samples of direct light per pixel; 0 leaves it black. Of light that rays meet by
  /// chance, the first `spp` samples are the first rays of indirect light.
  int direct_spp = 2;
  /// [0, 65536] samples of the suns at pixels around which some sample is lit and another is not
  /// (direct_sampler.h).
  int penumbra_spp = 16;
  int bounces = 3;         ///< [1, 64] bounces of indirect light after the first hit
  std::uint32_t seed = 0;  ///< different seeds give independent noise

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Renders the given frames of an animated scene. The bits of a frame depend on scene, animation,
/// options, frame number and the number of the frame before it only. They do not depend on the
/// number of threads or on which frames were rendered before.
class LiveSource final : public FrameSource {
 public:
  /// `scene` and `animation` must outlive the source. Motion vectors lead to the previous entry of
  /// `frames`; those of its first entry n lead to frame n - 1. Rendering starts at index `first` of
  /// `frames`, so that an interrupted run can be resumed. Throws std::invalid_argument if an option
  /// is out of range, `first` exceeds the size of `frames`, or a frame number has no predecessor.
  LiveSource(const Scene& scene, const Animation& animation, const RenderOptions& options,
             std::vector<int> frames, std::size_t first = 0);
  ~LiveSource() override;

  [[nodiscard]] bool next(Frame& frame) override;
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override;

  /// Writes to `out` the antialiased picture of the last frame that next() delivered. `indirect`
  /// and, unless null, `direct`, which are denoised and divided by albedo, replace the light of the
  /// frame; see render_picture(). `direct` holds sun() as it is. `frame` is not changed. Throws
  /// std::invalid_argument if `frame` is not the last delivered one, planes differ in size, the
  /// mode is kNone, or direct_spp is 0.
  PictureStats picture(const AntialiasOptions& options, const Frame& frame,
                       const Planes<3>& indirect, Planes<3>& out,
                       const Planes<3>* direct = nullptr);

  /// The two parts of Frame::direct of the last delivered frame. sun() has hard edges, and noise
  /// nowhere but there. soft() is light of sky and local lights, as soft and as noisy as indirect
  /// light; it also holds what the rays of resample() have met since.
  [[nodiscard]] const Planes<3>& sun() const;
  [[nodiscard]] const Planes<3>& soft() const;

  /// Makes resample() draw the extra samples of the last delivered frame again from the first one.
  /// Several methods can then share one rendering.
  void rewind_resampling();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace eigenlight
