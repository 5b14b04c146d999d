#include "temporal/gather/frame_link.h"

#include <cmath>

#include "frame/tiles.h"
#include "temporal/gather/count_pixels.h"

namespace eigenlight {
namespace {

// Pixel of an image that a place falls to; false outside.
bool nearest(Extent extent, float x, float y, int& px, int& py) {
  if (!(x > -0.5f && y > -0.5f && x < static_cast<float>(extent.width) &&
        y < static_cast<float>(extent.height))) {
    return false;
  }
  px = static_cast<int>(std::lround(x));
  py = static_cast<int>(std::lround(y));
  return extent.contains(px, py);
}

void fill_gap(const FrameLink& scattered, const Plane<PackedGuide>& guides, int x, int y,
              Link& link) {
  float best = kLeastMatch;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (!guides.extent().contains(x + dx, y + dy)) continue;
      const Link& near = scattered(x + dx, y + dy);
      if (near.known == 0.0f) continue;
      const float match = guide_weight(guides(x, y), guides(x + dx, y + dy));
      if (match <= best) continue;
      best = match;
      link = near;
    }
  }
}

}  // namespace

void link_back(const FrameInput& frame, FrameLink& link) {
  const Extent extent = frame.extent();
  ensure_extent(link, extent);
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      const float dx = frame.motion[0](x, y), dy = frame.motion[1](x, y);
      const float depth = frame.surface.depth(x, y), before = frame.previous_depth(x, y);
      const bool is_known = frame.previous_index >= 0 && frame.surface.id(x, y) != 0 &&
                            std::isfinite(dx) && std::isfinite(dy) && std::isfinite(depth) &&
                            std::isfinite(before) && depth > 0.0f && before > 0.0f;
      link(x, y) = is_known ? Link{dx, dy, std::log(before / depth), 1.0f} : Link{};
    }
  });
}

std::int64_t count_new(const FrameLink& back, const Plane<PackedGuide>& guides,
                       const Plane<PackedGuide>& before, const GuideWidths& widths) {
  return count_pixels(guides.extent(), [&](int x, int y) {
    if (!shows_surface(guides(x, y))) return false;
    const Link& link = back(x, y);
    int px = 0, py = 0;
    return link.known == 0.0f ||
           !nearest(guides.extent(), static_cast<float>(x) + link.x, static_cast<float>(y) + link.y,
                    px, py) ||
           guide_weight(guides(x, y), before(px, py), depth_steps(link.log_depth, widths)) <
               kLeastMatch;
  });
}

void LinkAhead::find(const FrameLink& back, const Plane<PackedGuide>& guides,
                     const Plane<PackedGuide>& before, const GuideWidths& widths, FrameLink& link) {
  const Extent extent = back.extent();
  ensure_extent(match_, extent);
  ensure_extent(link, extent);
  ensure_extent(scattered_, extent);
  match_.fill(0.0f);
  scattered_.fill({});
  // In the order of pixels, so that the first of equal matches stays whatever the threads.
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const Link& from = back(x, y);
      const float to_x = static_cast<float>(x) + from.x, to_y = static_cast<float>(y) + from.y;
      int px = 0, py = 0;
      if (from.known == 0.0f || !nearest(extent, to_x, to_y, px, py)) continue;
      const float same =
          guide_weight(guides(x, y), before(px, py), depth_steps(from.log_depth, widths));
      const float off = std::max(std::abs(to_x - static_cast<float>(px)),
                                 std::abs(to_y - static_cast<float>(py)));
      const float match = same * (1.0f - off);
      if (same < kLeastMatch || match <= match_(px, py)) continue;
      match_(px, py) = match;
      scattered_(px, py) = {-from.x, -from.y, -from.log_depth, 1.0f};
    }
  }
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      link(x, y) = scattered_(x, y);
      if (link(x, y).known == 0.0f) fill_gap(scattered_, before, x, y, link(x, y));
    }
  });
}

}  // namespace eigenlight
