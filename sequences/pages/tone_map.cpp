#include "sequences/pages/tone_map.h"

#include <algorithm>
#include <cmath>

#include "frame/tiles.h"
#include "sequences/metrics/metrics.h"

namespace eigenlight {
namespace {

std::array<float, 3> block_mean(const Planes<3>& colors, int block_x, int block_y, int factor) {
  const Extent extent = colors[0].extent();
  std::array<float, 3> mean{};
  float count = 0.0f;
  for (int y = block_y * factor; y < std::min((block_y + 1) * factor, extent.height); ++y) {
    for (int x = block_x * factor; x < std::min((block_x + 1) * factor, extent.width); ++x) {
      for (std::size_t c = 0; c < 3; ++c) mean[c] += colors[c](x, y);
      count += 1.0f;
    }
  }
  for (float& value : mean) value /= count;
  return mean;
}

}  // namespace

ToneMap::ToneMap(float exposure) : exposure_(exposure) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const double linear = static_cast<double>(i) / static_cast<double>(table_.size() - 1);
    table_[i] = static_cast<std::uint8_t>(std::lround(255.0 * display_value(linear, {})));
  }
}

Plane<std::uint8_t> ToneMap::apply(const Planes<3>& colors, int factor) const {
  Plane<std::uint8_t> out(shrunk(colors[0].extent(), factor), 3);
  parallel_for(out.height(), [&](int y) {
    for (int x = 0; x < out.width(); ++x) {
      const std::array<float, 3> mean = block_mean(colors, x, y, factor);
      const bool is_finite =
          std::isfinite(mean[0]) && std::isfinite(mean[1]) && std::isfinite(mean[2]);
      constexpr std::array<std::uint8_t, 3> kMagenta{255, 0, 255};
      for (std::size_t c = 0; c < 3; ++c) {
        out.at(x, y)[c] = is_finite ? to_byte(mean[c]) : kMagenta[c];
      }
    }
  });
  return out;
}

Extent ToneMap::shrunk(Extent extent, int factor) {
  return {std::max(extent.width / factor, 1), std::max(extent.height / factor, 1)};
}

std::uint8_t ToneMap::to_byte(float value) const {
  const float v = std::clamp(value * exposure_, 0.0f, 1.0f);
  return table_[static_cast<std::size_t>(v * static_cast<float>(table_.size() - 1) + 0.5f)];
}

}  // namespace eigenlight
