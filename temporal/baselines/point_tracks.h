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

/// The tracks of consecutive frames. Frames are visited from the last to the first. Every point
/// moves along its motion vector and ends where its surface is not found by the rule of
/// reproject/taps.h. A pixel that points cover by less than half starts a new point. Where two
/// points cover a pixel in full, further ones end. A track thus stays on one point of its object,
/// whatever moves.
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
