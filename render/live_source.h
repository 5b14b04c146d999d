// A FrameSource that renders.
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
  int spp = 3;             ///< [1, 65536] samples of indirect light per pixel
  int direct_spp = 8;      ///< [0, 65536] light samples of direct light; 0: `direct` is not wanted
  int bounces = 3;         ///< [1, 64] bounces of indirect light after the first hit
  std::uint32_t seed = 0;  ///< sequences of different seeds are independent

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Renders the given frames of an animated scene. Bits depend on scene, animation, options and
/// frame number only: not on threads, nor on which frames were rendered before.
class LiveSource final : public FrameSource {
 public:
  /// `scene` and `animation` must outlive the source. Motion leads to the frame before in `frames`;
  /// for the first, to its number minus one. `first` is the index in `frames` to start from
  /// (resume).
  LiveSource(const Scene& scene, const Animation& animation, const RenderOptions& options,
             std::vector<int> frames, std::size_t first = 0);
  ~LiveSource() override;

  [[nodiscard]] bool next(Frame& frame) override;
  [[nodiscard]] bool resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                              std::span<Planes<3>* const> means) override;

  /// The antialiased picture of the frame that next() delivered last, with `indirect` (filtered,
  /// over albedo) in place of its own; render_picture(). Changes nothing of `frame`. Throws
  /// std::invalid_argument if `frame` is another one, planes differ in size, the mode is kNone, or
  /// direct_spp is 0.
  PictureStats picture(const AntialiasOptions& options, const Frame& frame,
                       const Planes<3>& indirect, Planes<3>& out);

  /// Forgets the further samples that resample() drew for the frame that next() delivered last: the
  /// next call draws the same ones again. So several methods can share one rendering.
  void rewind_resampling();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace eigenlight
