#include "temporal/gather/color_record.h"

#include <cmath>

#include "frame/tiles.h"

namespace eigenlight {

void record_color(const Planes<3>& color, ColorRecord& record) {
  const Extent extent = color[0].extent();
  ensure_extent(record, extent);
  const auto packed = [](float value) {
    return static_cast<std::uint16_t>(std::lround(value / kColorStep));
  };
  parallel_for(extent.height, [&](int y) {
    for (int x = 0; x < extent.width; ++x) {
      const float r = color[0](x, y), g = color[1](x, y), b = color[2](x, y);
      const float low = std::min({r, g, b}), high = std::max({r, g, b});
      const bool is_usable = std::isfinite(r + g + b) && low >= 0.0f && high <= kMostColor;
      record(x, y) = is_usable ? PackedColor{packed(r), packed(g), packed(b), 1} : PackedColor{};
    }
  });
}

}  // namespace eigenlight
