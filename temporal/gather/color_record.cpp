#include "temporal/gather/color_record.h"

#include <cmath>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

PackedColor pack(float r, float g, float b) {
  const auto packed = [](float value) {
    return static_cast<std::uint16_t>(std::lround(value / kColorStep));
  };
  const float low = std::min({r, g, b}), high = std::max({r, g, b});
  const bool is_usable = std::isfinite(r + g + b) && low >= 0.0f && high <= kMostColor;
  return is_usable ? PackedColor{packed(r), packed(g), packed(b), 1} : PackedColor{};
}

// The largest channel of the pixels around one.
float scale_at(const Planes<3>& emission, int x, int y) {
  float most = 0.0f;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (!emission[0].extent().contains(x + dx, y + dy)) continue;
      for (const auto& plane : emission) {
        const float value = plane(x + dx, y + dy);
        if (std::isfinite(value)) most = std::max(most, value);
      }
    }
  }
  return most > 0.0f ? most : 1.0f;
}

}  // namespace

void record_color(const Planes<3>& color, ColorRecord& record) {
  const Extent extent = color[0].extent();
  ensure_extent(record, extent);
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      record(x, y) = pack(color[0](x, y), color[1](x, y), color[2](x, y));
    }
  });
}

void record_emission(const Planes<3>& emission, ColorRecord& record, Plane<float>& scale) {
  const Extent extent = emission[0].extent();
  ensure_extent(record, extent);
  ensure_extent(scale, extent);
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      scale(x, y) = scale_at(emission, x, y);
      const float over = 1.0f / scale(x, y);
      const float r = emission[0](x, y), g = emission[1](x, y), b = emission[2](x, y);
      PackedColor& to = record(x, y);
      to = pack(r * over, g * over, b * over);
      if (to.usable != 0 && std::max({r, g, b}) == 0.0f) to.usable = kCertainColor;
    }
  });
}

}  // namespace eigenlight
