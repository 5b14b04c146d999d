// Where the pixels of a tile are in the frames around theirs.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "frame/tiles.h"
#include "temporal/gather/color_record.h"
#include "temporal/gather/frame_link.h"
#include "temporal/gather/light_record.h"

namespace eigenlight {

/// Most frames on one side of a frame.
inline constexpr int kMostGathered = 64;

/// A frame on the way from the frame at hand.
struct GatherStep {
  const FrameLink* link;             ///< to it from the step before; first: from the frame at hand
  const Plane<PackedGuide>* guides;  ///< its own
  std::vector<const LightRecord*> lights;  ///< for each layer of light
  std::vector<const ColorRecord*> colors;  ///< for each color
};

/// Frames before or after the frame at hand, the closest first.
using GatherWalk = std::vector<GatherStep>;

/// The four pixels around a place: (x, y), its neighbors to the right and below. Weights are
/// bilinear weights times guide_weight(), 0 outside of the picture. total: their sum, 0 where the
/// pixel is not seen.
struct FrameTaps {
  int x, y;
  std::array<float, 4> weight;
  float total;
};

/// Calls visit(x, y, weight) for the taps that count.
template <typename Visit>
void each_tap(const FrameTaps& taps, const Visit& visit) {
  for (std::size_t t = 0; t < 4; ++t) {
    if (taps.weight[t] == 0.0f) continue;
    visit(taps.x + static_cast<int>(t % 2), taps.y + static_cast<int>(t / 2), taps.weight[t]);
  }
}

/// Taps of all pixels of a rectangle in all frames of some walks. A pixel follows the links of the
/// pixels around its place, by their weights; its walk ends where guides match by less than
/// kLeastMatch in sum, or less than half of the way is known.
class FramePlaces {
 public:
  void find(const Rect& area, const Plane<PackedGuide>& guides, const GuideWidths& widths,
            std::span<const GatherWalk> walks);

  [[nodiscard]] std::size_t frames() const { return steps_.size(); }
  [[nodiscard]] const GatherStep& step(std::size_t frame) const { return *steps_[frame]; }
  /// Of the pixels of the rectangle, in the order of rows.
  [[nodiscard]] std::span<const FrameTaps> taps(std::size_t frame) const {
    const auto pixels = static_cast<std::size_t>(area_.pixels());
    return std::span(taps_).subspan(frame * pixels, pixels);
  }

 private:
  std::vector<const GatherStep*> steps_;
  std::vector<FrameTaps> taps_;
  Rect area_;
};

}  // namespace eigenlight
