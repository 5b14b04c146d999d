#include "render/scene/texture_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace eigenlight {
namespace {

float srgb_to_linear(float s) {  // IEC 61966-2-1
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

const std::array<float, 256>& linear_table() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {
      t[static_cast<std::size_t>(i)] = srgb_to_linear(static_cast<float>(i) / 255.0f);
    }
    return t;
  }();
  return table;
}

// Inverse of linear_table(). With 65536 entries, even the narrowest sRGB code spans 20 of them.
std::uint32_t linear_to_byte(float linear) {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(65536);
    const auto& codes = linear_table();
    std::size_t code = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const float value = static_cast<float>(i) / 65535.0f;
      while (code < 255 && value > 0.5f * (codes[code] + codes[code + 1])) ++code;
      t[i] = static_cast<std::uint8_t>(code);
    }
    return t;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0f, 1.0f) * 65535.0f + 0.5f)];
}

glm::vec3 decode(std::uint32_t texel) {
  const auto& table = linear_table();
  return {table[texel & 255U], table[texel >> 8 & 255U], table[texel >> 16 & 255U]};
}

// Index of the texel that contains u in a repeating image of `size` texels; 0 for NaN.
int wrap(float u, int size) {
  const float fraction = u - std::floor(u);
  const int i = fraction > 0.0f ? static_cast<int>(fraction * static_cast<float>(size)) : 0;
  return std::min(i, size - 1);  // a fraction just below 1 can round up to `size`
}

// The two texels around u along one axis, and the weight of the second.
struct Taps {
  int first = 0, second = 0;
  float weight = 0.0f;
};

Taps taps(float u, int size) {
  const float x = (u - std::floor(u)) * static_cast<float>(size) - 0.5f;
  const float base = std::floor(x);
  if (!(base >= -1.0f)) return {};  // NaN
  const int i = static_cast<int>(base);
  return {i < 0 ? size - 1 : std::min(i, size - 1), i + 1 >= size ? 0 : i + 1, x - base};
}

}  // namespace

float bilinear_alpha(const Texture& texture, const glm::vec2& uv) {
  const Taps x = taps(uv.x, texture.extent.width);
  const Taps y = taps(uv.y, texture.extent.height);
  const auto alpha = [&](int i, int j) {
    const std::size_t index =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(texture.extent.width) +
        static_cast<std::size_t>(i);
    return static_cast<float>(texture.rgba[4 * index + 3]);
  };
  const float top = glm::mix(alpha(x.first, y.first), alpha(x.second, y.first), x.weight);
  const float bottom = glm::mix(alpha(x.first, y.second), alpha(x.second, y.second), x.weight);
  return glm::mix(top, bottom, y.weight) / 255.0f;
}

TexturePyramid::TexturePyramid(const Texture& texture) {
  Level full{texture.extent, std::vector<std::uint32_t>(texture.extent.pixels())};
  std::memcpy(full.texels.data(), texture.rgba.data(), 4 * full.texels.size());
  levels_.push_back(std::move(full));
  while (levels_.back().extent.width > 1 || levels_.back().extent.height > 1) {
    levels_.push_back(halve(levels_.back()));
  }
}

TexturePyramid::Level TexturePyramid::halve(const Level& fine) {
  Level coarse;
  coarse.extent = {std::max(1, fine.extent.width / 2), std::max(1, fine.extent.height / 2)};
  coarse.texels.reserve(coarse.extent.pixels());
  for (int y = 0; y < coarse.extent.height; ++y) {
    for (int x = 0; x < coarse.extent.width; ++x) {
      glm::vec3 weighted(0.0f), plain(0.0f);
      float alpha = 0.0f;
      for (int k = 0; k < 4; ++k) {
        const int i = std::min(2 * x + k % 2, fine.extent.width - 1);
        const int j = std::min(2 * y + k / 2, fine.extent.height - 1);
        const std::uint32_t texel =
            fine.texels[static_cast<std::size_t>(j * fine.extent.width + i)];
        const float a = static_cast<float>(texel >> 24);
        plain += decode(texel);
        weighted += a * decode(texel);
        alpha += a;
      }
      const glm::vec3 color = alpha > 0.0f ? weighted / alpha : plain / 4.0f;
      coarse.texels.push_back(linear_to_byte(color.x) | linear_to_byte(color.y) << 8 |
                              linear_to_byte(color.z) << 16 |
                              static_cast<std::uint32_t>(alpha / 4.0f + 0.5f) << 24);
    }
  }
  return coarse;
}

glm::vec3 TexturePyramid::bilinear(const Level& level, const glm::vec2& uv) {
  const Taps x = taps(uv.x, level.extent.width);
  const Taps y = taps(uv.y, level.extent.height);
  const auto color = [&](int i, int j) {
    return decode(level.texels[static_cast<std::size_t>(j * level.extent.width + i)]);
  };
  return glm::mix(glm::mix(color(x.first, y.first), color(x.second, y.first), x.weight),
                  glm::mix(color(x.first, y.second), color(x.second, y.second), x.weight),
                  y.weight);
}

glm::vec3 TexturePyramid::trilinear(const glm::vec2& uv, float level) const {
  const float top = static_cast<float>(levels() - 1);
  const float l = level > 0.0f ? std::min(level, top) : 0.0f;
  const auto fine = static_cast<std::size_t>(l);
  const glm::vec3 color = bilinear(levels_[fine], uv);
  const float weight = l - static_cast<float>(fine);
  if (!(weight > 0.0f)) return color;
  return glm::mix(color, bilinear(levels_[fine + 1], uv), weight);
}

const std::uint32_t& TexturePyramid::nearest_texel(const glm::vec2& uv, int level) const {
  const Level& l = levels_[static_cast<std::size_t>(std::clamp(level, 0, levels() - 1))];
  const int x = wrap(uv.x, l.extent.width);
  const int y = wrap(uv.y, l.extent.height);
  return l.texels[static_cast<std::size_t>(y * l.extent.width + x)];
}

glm::vec3 TexturePyramid::color(std::uint32_t texel) { return decode(texel); }

}  // namespace eigenlight
