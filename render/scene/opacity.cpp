#include "render/scene/opacity.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {
namespace {

constexpr float kRounding = 1e-3f;  // 100 ulps of interpolated 8-bit values

// Larger texture coordinates have too few digits to identify texels.
constexpr float kMaxCoordinate = 1024.0f;

}  // namespace

OpacityMap::OpacityMap(const Texture& texture, float cutoff) : extent_(texture.extent) {
  const auto width = static_cast<std::size_t>(extent_.width);
  const auto height = static_cast<std::size_t>(extent_.height);
  sums_.resize((width + 1) * (height + 1));
  for (std::size_t y = 0; y < height; ++y) {
    Counts row;
    for (std::size_t x = 0; x < width; ++x) {
      const auto alpha = static_cast<float>(texture.rgba[4 * (y * width + x) + 3]);
      if (alpha >= 255.0f * cutoff + kRounding) ++row.solid;
      if (alpha <= 255.0f * cutoff - kRounding) ++row.hole;
      const Counts& above = sums_[y * (width + 1) + x + 1];
      sums_[(y + 1) * (width + 1) + x + 1] = {above.solid + row.solid, above.hole + row.hole};
    }
  }
}

// Texels that bilinear interpolation reads between two coordinates, plus one on either side for
// rounding; all texels if the span exceeds the texture.
OpacityMap::Span OpacityMap::touched(float low, float high, int size) {
  if (!(low > -kMaxCoordinate && high < kMaxCoordinate)) return {0, size};
  const auto scale = static_cast<float>(size);
  const int first = static_cast<int>(std::floor(low * scale - 0.5f)) - 1;
  const int last = static_cast<int>(std::floor(high * scale - 0.5f)) + 2;
  if (last - first + 1 >= size) return {0, size};
  return {(first % size + size) % size, last - first + 1};
}

OpacityMap::Counts OpacityMap::count(const Span& x, const Span& y) const {
  const auto sum = [&](int i, int j) {
    return sums_[static_cast<std::size_t>(j) * (static_cast<std::size_t>(extent_.width) + 1) +
                 static_cast<std::size_t>(i)];
  };
  const Counts a = sum(x.first, y.first), b = sum(x.first + x.count, y.first);
  const Counts c = sum(x.first, y.first + y.count), d = sum(x.first + x.count, y.first + y.count);
  return {d.solid - b.solid - c.solid + a.solid, d.hole - b.hole - c.hole + a.hole};
}

Opacity OpacityMap::classify(const std::array<glm::vec2, 3>& uv) const {
  for (const glm::vec2& corner : uv) {
    if (!std::isfinite(corner.x) || !std::isfinite(corner.y)) return Opacity::kMixed;
  }
  const auto [left, right] = std::minmax({uv[0].x, uv[1].x, uv[2].x});
  const auto [top, bottom] = std::minmax({uv[0].y, uv[1].y, uv[2].y});
  const Span x = touched(left, right, extent_.width);
  const Span y = touched(top, bottom, extent_.height);
  Counts all;
  // A span that wraps around is split into two.
  const auto parts = [](const Span& s, int size) {
    const int before = std::min(s.count, size - s.first);
    return std::array<Span, 2>{Span{s.first, before}, Span{0, s.count - before}};
  };
  for (const Span& j : parts(y, extent_.height)) {
    for (const Span& i : parts(x, extent_.width)) {
      const Counts part = count(i, j);
      all.solid += part.solid;
      all.hole += part.hole;
    }
  }
  const auto texels = static_cast<std::uint32_t>(x.count) * static_cast<std::uint32_t>(y.count);
  if (all.solid == texels) return Opacity::kSolid;
  return all.hole == texels ? Opacity::kHole : Opacity::kMixed;
}

}  // namespace eigenlight
