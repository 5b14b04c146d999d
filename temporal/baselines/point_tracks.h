// Points of surfaces, followed through a whole sequence.
#pragma once

#include <span>
#include <vector>

#include "reproject/taps.h"

namespace eigenlight {

/// A track's place and light in one frame.
struct TrackSample {
  std::uint32_t track = 0;
  glm::ivec2 corner{0};           ///< its taps: corner + (t % 2, t / 2)
  std::array<float, 4> weight{};  ///< of the taps, sum 1; taps of weight 0 may lie outside
  glm::vec3 light{0.0f};          ///< read there; 0 if not usable
  bool is_usable = false;         ///< some tap's light is finite
};

/// The tracks of frames that follow each other, each frame leading to the one before it. From the
/// last frame to the first: every point goes where its motion leads, as far as it finds its surface
/// there by the rule of reproject/taps.h, and each pixel that points cover by less than half of a
/// pixel starts one of its own. Where two points cover a pixel in full, further ones end.
/// Points that stay are thus the same points of their objects in all frames, whatever moves.
class PointTracks {
 public:
  /// Throws std::invalid_argument if there is no frame or sizes differ.
  PointTracks(std::span<const Frame* const> frames, const TapOptions& options);

  [[nodiscard]] int frames() const { return static_cast<int>(samples_.size()); }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Of frame t, by rising track.
  [[nodiscard]] std::span<const TrackSample> samples(int t) const {
    return samples_[static_cast<std::size_t>(t)];
  }
  /// The part of samples(t) whose tracks are in [first, last).
  [[nodiscard]] std::span<const TrackSample> samples(int t, std::uint32_t first,
                                                     std::uint32_t last) const;

 private:
  std::vector<std::vector<TrackSample>> samples_;
  std::uint32_t count_ = 0;
};

}  // namespace eigenlight
