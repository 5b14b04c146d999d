#include "temporal/gather/frame_places.h"

#include <cmath>

namespace eigenlight {
namespace {

struct Place {
  float x, y, log_depth;
};

// Sets the four pixels around a place. False where none matches.
bool find_taps(const Plane<PackedGuide>& there, const PackedGuide& guide, const Place& place,
               const GuideWidths& widths, FrameTaps& taps) {
  const Extent extent = there.extent();
  if (!(place.x > -1.0f && place.y > -1.0f && place.x < static_cast<float>(extent.width) &&
        place.y < static_cast<float>(extent.height))) {
    return false;
  }
  const float left = std::floor(place.x), top = std::floor(place.y);
  const float fx = place.x - left, fy = place.y - top;
  const std::int32_t steps = depth_steps(place.log_depth, widths);
  taps = {static_cast<int>(left), static_cast<int>(top), {}, 0.0f};
  for (std::size_t t = 0; t < 4; ++t) {
    const bool is_right = t % 2 != 0, is_low = t / 2 != 0;
    const int x = taps.x + is_right, y = taps.y + is_low;
    if (!extent.contains(x, y)) continue;
    const float bilinear = (is_right ? fx : 1.0f - fx) * (is_low ? fy : 1.0f - fy);
    taps.weight[t] = bilinear * guide_weight(guide, there(x, y), steps);
    taps.total += taps.weight[t];
  }
  return taps.total >= kLeastMatch;
}

// Goes on by the links of the pixels around a place. False where half of them are not known.
bool follow_link(const FrameLink& link, const FrameTaps& taps, Place& place) {
  Link sum{};
  each_tap(taps, [&](int x, int y, float weight) {
    const Link& from = link(x, y);
    sum.x += weight * from.x;
    sum.y += weight * from.y;
    sum.log_depth += weight * from.log_depth;
    sum.known += weight * from.known;
  });
  if (sum.known < 0.5f * taps.total) return false;
  const float over = 1.0f / sum.known;
  place = {place.x + sum.x * over, place.y + sum.y * over, place.log_depth + sum.log_depth * over};
  return true;
}

// Taps of a pixel along a walk, `pixels` values apart.
void follow(const GatherWalk& walk, const PackedGuide& guide, const GuideWidths& widths, int x,
            int y, FrameTaps* out, std::size_t pixels) {
  if (walk.empty()) return;
  const Link& first = (*walk.front().link)(x, y);
  if (first.known == 0.0f) return;
  Place place{static_cast<float>(x) + first.x, static_cast<float>(y) + first.y, first.log_depth};
  FrameTaps taps;
  for (std::size_t s = 0; s < walk.size(); ++s) {
    if (s > 0 && !follow_link(*walk[s].link, taps, place)) return;
    if (!find_taps(*walk[s].guides, guide, place, widths, taps)) return;
    out[s * pixels] = taps;
  }
}

}  // namespace

void FramePlaces::find(const Rect& area, const Plane<PackedGuide>& guides,
                       const GuideWidths& widths, std::span<const GatherWalk> walks) {
  area_ = area;
  steps_.clear();
  for (const GatherWalk& walk : walks) {
    for (const GatherStep& step : walk) steps_.push_back(&step);
  }
  const auto pixels = static_cast<std::size_t>(area.pixels());
  taps_.assign(steps_.size() * pixels, FrameTaps{});
  FrameTaps* at = taps_.data();
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; ++x, ++at) {
      const PackedGuide& guide = guides(x, y);
      if (!shows_surface(guide)) continue;
      FrameTaps* out = at;
      for (const GatherWalk& walk : walks) {
        follow(walk, guide, widths, x, y, out, pixels);
        out += walk.size() * pixels;
      }
    }
  }
}

}  // namespace eigenlight
