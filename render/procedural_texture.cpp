#include "render/procedural_texture.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "frame/random.h"

namespace eigenlight {
namespace {

constexpr Extent kTiled{512, 512}, kPicture{256, 192};

std::uint8_t to_srgb8(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float s = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(s * 255.0f));
}

template <typename Color>
Texture paint(const std::string& name, Extent extent, const Color& color) {
  Texture texture{name, extent, {}};
  texture.rgba.reserve(extent.pixels() * 4);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::vec2 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(extent.width),
                         (static_cast<float>(y) + 0.5f) / static_cast<float>(extent.height));
      const glm::vec3 c = color(uv);
      texture.rgba.insert(texture.rgba.end(),
                          {to_srgb8(c.r), to_srgb8(c.g), to_srgb8(c.b), std::uint8_t{255}});
    }
  }
  return texture;
}

float lattice(int x, int y, std::uint32_t seed) {
  return to_unit(hash_key(seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
}

/// Value noise in [0, 1] that repeats after `cells` in both axes.
float noise(const glm::vec2& uv, glm::ivec2 cells, std::uint32_t seed) {
  const glm::vec2 p = uv * glm::vec2(cells);
  const glm::vec2 base = floor(p), f = p - base;
  const glm::vec2 w = f * f * (3.0f - 2.0f * f);
  const auto at = [&](int i, int j) {
    const int x = static_cast<int>(base.x) + i, y = static_cast<int>(base.y) + j;
    return lattice((x % cells.x + cells.x) % cells.x, (y % cells.y + cells.y) % cells.y, seed);
  };
  return glm::mix(glm::mix(at(0, 0), at(1, 0), w.x), glm::mix(at(0, 1), at(1, 1), w.x), w.y);
}

/// Five octaves, in [0, 1], mean near 0.5.
float fractal(const glm::vec2& uv, glm::ivec2 cells, std::uint32_t seed) {
  float sum = 0.0f, weight = 0.5f, total = 0.0f;
  for (std::uint32_t octave = 0; octave < 5; ++octave) {
    sum += weight * noise(uv, cells, seed + octave);
    total += weight;
    weight *= 0.5f;
    cells *= 2;
  }
  return sum / total;
}

float smooth(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// Hills under a sky with a sun.
glm::vec3 landscape(const glm::vec2& uv, std::uint32_t seed) {
  const float hue = lattice(1, 2, seed);
  const glm::vec3 zenith =
      glm::mix(glm::vec3(0.08f, 0.2f, 0.55f), glm::vec3(0.5f, 0.12f, 0.2f), hue);
  const glm::vec3 horizon(0.9f, 0.65f, 0.35f);
  glm::vec3 color = glm::mix(zenith, horizon, smooth(0.0f, 0.7f, uv.y));
  const glm::vec2 sun(0.2f + 0.6f * lattice(3, 4, seed), 0.35f);
  const float to_sun = glm::length((uv - sun) * glm::vec2(1.33f, 1.0f));
  color = glm::mix(glm::vec3(0.95f, 0.9f, 0.6f), color, smooth(0.07f, 0.09f, to_sun));
  for (int hill = 0; hill < 3; ++hill) {
    const float near = static_cast<float>(hill) / 2.0f;
    const auto hill_seed = seed + 17U * static_cast<std::uint32_t>(hill + 1);
    const float ridge =
        0.5f + 0.16f * near - 0.2f * (fractal({uv.x, 0.5f}, {3, 3}, hill_seed) - 0.5f);
    const glm::vec3 ground =
        glm::mix(glm::vec3(0.25f, 0.3f, 0.45f), glm::vec3(0.06f + 0.3f * hue, 0.22f, 0.05f), near);
    const float grain = 0.7f + 0.6f * fractal(uv, {24, 18}, hill_seed + 5U);
    color = glm::mix(color, ground * grain, smooth(ridge, ridge + 0.01f, uv.y));
  }
  return color;
}

/// Saturated from a hue in [0, 1].
glm::vec3 rainbow(float hue) {
  const glm::vec3 phase = glm::vec3(hue) + glm::vec3(0.0f, 1.0f / 3.0f, 2.0f / 3.0f);
  return 0.42f + 0.4f * cos(phase * glm::two_pi<float>());
}

/// Overlapping discs and bars.
glm::vec3 abstract(const glm::vec2& uv, std::uint32_t seed) {
  glm::vec3 color = glm::mix(glm::vec3(0.8f, 0.74f, 0.6f), glm::vec3(0.65f, 0.6f, 0.5f),
                             fractal(uv, {6, 5}, seed));
  for (int i = 0; i < 9; ++i) {
    const auto random = [&](int k) { return lattice(i, k, seed + 101U); };
    const glm::vec2 d = (uv - glm::vec2(random(0), random(1))) * glm::vec2(1.33f, 1.0f);
    const float turn = random(2) * glm::pi<float>(), size = 0.06f + 0.16f * random(3);
    const glm::vec2 along(std::cos(turn) * d.x + std::sin(turn) * d.y,
                          std::cos(turn) * d.y - std::sin(turn) * d.x);
    const float disc = glm::length(d) - size;
    const float bar = std::max(std::abs(along.x) - 2.0f * size, std::abs(along.y) - 0.2f * size);
    const float inside = 1.0f - smooth(-0.004f, 0.004f, i % 3 == 0 ? bar : disc);
    color = glm::mix(color, rainbow(random(4)), 0.85f * inside);
  }
  return color;
}

}  // namespace

Texture paint_masonry(const std::string& name, const Masonry& m) {
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const int row = static_cast<int>(uv.y * static_cast<float>(m.rows));
    const float moved = uv.x * static_cast<float>(m.columns) + (row % 2 == 1 ? m.shift : 0.0f);
    const int column = static_cast<int>(std::floor(moved)) % m.columns;
    const glm::vec2 in_stone(moved - std::floor(moved),
                             uv.y * static_cast<float>(m.rows) - static_cast<float>(row));
    const glm::vec2 to_edge = glm::min(in_stone, 1.0f - in_stone) /
                              glm::vec2(static_cast<float>(m.columns), static_cast<float>(m.rows));
    const float wobble = 0.6f + 0.8f * fractal(uv, {32, 32}, m.seed + 7U);
    const float joint = smooth(0.5f * m.joint, m.joint, std::min(to_edge.x, to_edge.y) * wobble);
    const float pick =
        m.checker ? static_cast<float>((row + column) % 2) : lattice(column, row, m.seed + 3U);
    const float grain = 0.75f + 0.5f * fractal(uv, {8, 8}, m.seed);
    return glm::mix(m.joint_color, glm::mix(m.stone, m.other, pick) * grain, joint);
  });
}

Texture paint_clouds(const std::string& name, const Clouds& clouds) {
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const float f = fractal(uv, glm::ivec2(clouds.cells), clouds.seed);
    return glm::mix(clouds.dark, clouds.light, smooth(0.2f, 0.8f, f));
  });
}

Texture paint_boards(const std::string& name, const Boards& boards) {
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const float across = uv.x * static_cast<float>(boards.boards);
    const int board = static_cast<int>(across);
    const float edge = std::min(across - std::floor(across), std::ceil(across) - across);
    const auto seed = boards.seed + 31U * static_cast<std::uint32_t>(board);
    // A board is cut once, at its own place.
    const float cut = std::abs(uv.y - lattice(board, 1, boards.seed));
    const float grain = fractal(uv, {48, 3}, seed);
    const float tone = 0.6f * grain + 0.4f * lattice(board, 2, boards.seed);
    const float groove = smooth(0.0f, 0.05f, edge) * smooth(0.0f, 0.006f, cut);
    return glm::mix(boards.dark, boards.light, tone) * glm::mix(0.35f, 1.0f, groove);
  });
}

Texture paint_cloth(const std::string& name, const Cloth& cloth) {
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const float side = std::min(uv.x, 1.0f - uv.x), end = std::min(uv.y, 1.0f - uv.y);
    const float border = std::min(side / 1.0f, end * 2.0f);
    const bool in_border = border > 0.05f && border < 0.09f;
    const glm::vec2 cell = glm::vec2(uv.x * 3.0f, uv.y * 6.0f);
    const glm::vec2 d = abs(cell - floor(cell) - 0.5f);
    const bool lozenge = border > 0.14f && d.x + d.y < 0.22f;
    const float weave = 0.85f + 0.3f * noise(uv, {128, 128}, 5U);
    return (in_border || lozenge ? cloth.pattern : cloth.ground) * weave;
  });
}

Texture paint_picture(const std::string& name, std::uint32_t seed) {
  return paint(name, kPicture, [&](const glm::vec2& uv) {
    return seed % 2 == 0 ? landscape(uv, mix32(seed)) : abstract(uv, mix32(seed));
  });
}

}  // namespace eigenlight
