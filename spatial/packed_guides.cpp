#include "spatial/packed_guides.h"

#include <cmath>

#include "frame/check.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

// Widths between a surface and what is none: weight 0.
constexpr float kNoSurface = 8.0f;
// Differences of two such values fit 16 bits and a sign: depths from 1e-9 to 1e9 at half a width.
constexpr float kMostWidths = 45.0f;

std::int16_t in_steps(float widths) {
  return static_cast<std::int16_t>(
      std::lround(std::clamp(widths, -kMostWidths, kMostWidths) * kGuideSteps));
}

// A value of [low, high].
std::int16_t packed(float value, float low, float high, float width) {
  return std::isfinite(value) ? in_steps(std::clamp(value, low, high) / width) : std::int16_t{0};
}

}  // namespace

void GuideWidths::validate() const {
  EL_CHECK(normal > 0.0f && normal <= 10.0f, "normal {}: expected (0, 10]", normal);
  EL_CHECK(color > 0.0f && color <= 10.0f, "color {}: expected (0, 10]", color);
  EL_CHECK(depth > 0.0f && depth <= 10.0f, "depth {}: expected (0, 10]", depth);
}

void pack_guides(const FrameInput& frame, const GuideWidths& widths, Plane<PackedGuide>& out) {
  const Extent extent = frame.extent();
  ensure_extent(out, extent);
  const Planes<3>& normal = frame.mean_normal[0].empty() ? frame.surface.normal : frame.mean_normal;
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      PackedGuide& to = out(x, y);
      const float depth = frame.surface.depth(x, y);
      const bool is_surface = frame.surface.id(x, y) != 0 && std::isfinite(depth) && depth > 0.0f;
      for (std::size_t c = 0; c < 3; ++c) {
        to.normal_color[c] = packed(normal[c](x, y), -2.0f, 2.0f, widths.normal);
        // Colors above 1 are those of lamps; they differ enough.
        to.normal_color[3 + c] = packed(frame.surface.albedo[c](x, y), 0.0f, 2.0f, widths.color);
      }
      to.depth = is_surface ? in_steps(std::log(depth) / widths.depth) : std::int16_t{0};
      to.other = is_surface ? std::int16_t{0} : in_steps(kNoSurface);
    }
  });
}

}  // namespace eigenlight
