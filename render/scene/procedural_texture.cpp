#include "render/scene/procedural_texture.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "frame/random.h"
#include "frame/tiles.h"

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
  Texture texture{name, extent, std::vector<std::uint8_t>(extent.pixels() * 4)};
  parallel_for(extent.height, [&](int y) {
    std::uint8_t* to =
        &texture.rgba[4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(extent.width)];
    for (int x = 0; x < extent.width; ++x) {
      const glm::vec2 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(extent.width),
                         (static_cast<float>(y) + 0.5f) / static_cast<float>(extent.height));
      const glm::vec3 c = color(uv);
      for (int k = 0; k < 3; ++k) *to++ = to_srgb8(c[k]);
      *to++ = 255;
    }
  });
  return texture;
}

float lattice(int x, int y, std::uint32_t seed) {
  return to_unit(hash_key(seed, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
}

/// Value noise in [0, 1] over the unit square with `cells` cells per axis; it repeats.
class Noise {
 public:
  Noise(const glm::ivec2& cells, std::uint32_t seed) : cells_(cells) {
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) values_.push_back(lattice(x, y, seed));
    }
  }
  /// `uv` must not be negative.
  [[nodiscard]] float operator()(const glm::vec2& uv) const {
    const glm::vec2 p = uv * glm::vec2(cells_);
    const glm::vec2 base = floor(p), f = p - base;
    const glm::vec2 w = f * f * (3.0f - 2.0f * f);
    const glm::ivec2 low = glm::ivec2(base) % cells_, high = (low + 1) % cells_;
    return glm::mix(glm::mix(at(low.x, low.y), at(high.x, low.y), w.x),
                    glm::mix(at(low.x, high.y), at(high.x, high.y), w.x), w.y);
  }

 private:
  [[nodiscard]] float at(int x, int y) const {
    return values_[static_cast<std::size_t>(y * cells_.x + x)];
  }

  glm::ivec2 cells_;
  std::vector<float> values_;
};

/// Sum of five octaves of noise in [0, 1] with a mean near 0.5.
class Fractal {
 public:
  Fractal(glm::ivec2 cells, std::uint32_t seed) {
    for (std::uint32_t octave = 0; octave < 5; ++octave) {
      octaves_.emplace_back(cells, seed + octave);
      cells *= 2;
    }
  }
  [[nodiscard]] float operator()(const glm::vec2& uv) const {
    float sum = 0.0f, weight = 0.5f, total = 0.0f;
    for (const Noise& octave : octaves_) {
      sum += weight * octave(uv);
      total += weight;
      weight *= 0.5f;
    }
    return sum / total;
  }

 private:
  std::vector<Noise> octaves_;
};

float smooth(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// Hills under a sky with a sun.
class Landscape {
 public:
  explicit Landscape(std::uint32_t seed)
      : hue_(lattice(1, 2, seed)), sun_(0.2f + 0.6f * lattice(3, 4, seed), 0.35f) {
    for (std::uint32_t hill = 1; hill <= kHills; ++hill) {
      ridges_.emplace_back(glm::ivec2(3, 3), seed + 17U * hill);
      grains_.emplace_back(glm::ivec2(24, 18), seed + 17U * hill + 5U);
    }
  }
  [[nodiscard]] glm::vec3 operator()(const glm::vec2& uv) const {
    const glm::vec3 horizon(0.9f, 0.65f, 0.35f), disc(0.95f, 0.9f, 0.6f);
    const glm::vec3 zenith =
        glm::mix(glm::vec3(0.08f, 0.2f, 0.55f), glm::vec3(0.5f, 0.12f, 0.2f), hue_);
    const float to_sun = glm::length((uv - sun_) * glm::vec2(1.33f, 1.0f));
    glm::vec3 color = glm::mix(zenith, horizon, smooth(0.0f, 0.7f, uv.y));
    color = glm::mix(disc, color, smooth(0.07f, 0.09f, to_sun));
    for (std::size_t hill = 0; hill < kHills; ++hill) {
      const float near = static_cast<float>(hill) / (kHills - 1);
      const float ridge = 0.5f + 0.16f * near - 0.2f * (ridges_[hill]({uv.x, 0.5f}) - 0.5f);
      const glm::vec3 ground = glm::mix(glm::vec3(0.25f, 0.3f, 0.45f),
                                        glm::vec3(0.06f + 0.3f * hue_, 0.22f, 0.05f), near);
      const float grain = 0.7f + 0.6f * grains_[hill](uv);
      color = glm::mix(color, ground * grain, smooth(ridge, ridge + 0.01f, uv.y));
    }
    return color;
  }

 private:
  static constexpr std::size_t kHills = 3;
  float hue_;
  glm::vec2 sun_;
  std::vector<Fractal> ridges_, grains_;
};

/// Saturated color of a hue in [0, 1].
glm::vec3 rainbow(float hue) {
  const glm::vec3 phase = glm::vec3(hue) + glm::vec3(0.0f, 1.0f / 3.0f, 2.0f / 3.0f);
  return 0.42f + 0.4f * cos(phase * glm::two_pi<float>());
}

/// Overlapping discs and bars on `paper`.
glm::vec3 abstract(const glm::vec2& uv, const glm::vec3& paper, std::uint32_t seed) {
  glm::vec3 color = paper;
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
  const Fractal edges({32, 32}, m.seed + 7U), grains({8, 8}, m.seed);
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const int row = static_cast<int>(uv.y * static_cast<float>(m.rows));
    const float moved = uv.x * static_cast<float>(m.columns) + (row % 2 == 1 ? m.shift : 0.0f);
    const int column = static_cast<int>(std::floor(moved)) % m.columns;
    const glm::vec2 in_stone(moved - std::floor(moved),
                             uv.y * static_cast<float>(m.rows) - static_cast<float>(row));
    const glm::vec2 to_edge = glm::min(in_stone, 1.0f - in_stone) /
                              glm::vec2(static_cast<float>(m.columns), static_cast<float>(m.rows));
    const float wobble = 0.6f + 0.8f * edges(uv);
    const float joint = smooth(0.5f * m.joint, m.joint, std::min(to_edge.x, to_edge.y) * wobble);
    const float pick =
        m.checker ? static_cast<float>((row + column) % 2) : lattice(column, row, m.seed + 3U);
    const float grain = 0.75f + 0.5f * grains(uv);
    return glm::mix(m.joint_color, glm::mix(m.stone, m.other, pick) * grain, joint);
  });
}

Texture paint_clouds(const std::string& name, const Clouds& clouds) {
  const Fractal fractal(glm::ivec2(clouds.cells), clouds.seed);
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    return glm::mix(clouds.dark, clouds.light, smooth(0.2f, 0.8f, fractal(uv)));
  });
}

Texture paint_boards(const std::string& name, const Boards& boards) {
  std::vector<Fractal> grains;
  for (int i = 0; i < boards.boards; ++i) {
    grains.emplace_back(glm::ivec2(48, 3), boards.seed + 31U * static_cast<std::uint32_t>(i));
  }
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const float across = uv.x * static_cast<float>(boards.boards);
    const int board = static_cast<int>(across);
    const float edge = std::min(across - std::floor(across), std::ceil(across) - across);
    // Each board has one joint across, at a random position.
    const float cut = std::abs(uv.y - lattice(board, 1, boards.seed));
    const float grain = grains[static_cast<std::size_t>(board)](uv);
    const float tone = 0.6f * grain + 0.4f * lattice(board, 2, boards.seed);
    const float groove = smooth(0.0f, 0.05f, edge) * smooth(0.0f, 0.006f, cut);
    return glm::mix(boards.dark, boards.light, tone) * glm::mix(0.35f, 1.0f, groove);
  });
}

Texture paint_cloth(const std::string& name, const Cloth& cloth) {
  const Noise threads({128, 128}, 5U);
  return paint(name, kTiled, [&](const glm::vec2& uv) {
    const float side = std::min(uv.x, 1.0f - uv.x), end = std::min(uv.y, 1.0f - uv.y);
    const float border = std::min(side, end * 2.0f);
    const bool in_border = border > 0.05f && border < 0.09f;
    const glm::vec2 cell = glm::vec2(uv.x * 3.0f, uv.y * 6.0f);
    const glm::vec2 d = abs(cell - floor(cell) - 0.5f);
    const bool lozenge = border > 0.14f && d.x + d.y < 0.22f;
    const float weave = 0.85f + 0.3f * threads(uv);
    return (in_border || lozenge ? cloth.pattern : cloth.ground) * weave;
  });
}

Texture paint_picture(const std::string& name, std::uint32_t seed) {
  const std::uint32_t mixed = mix32(seed);
  if (seed % 2 == 0) return paint(name, kPicture, Landscape(mixed));
  const Fractal paper({6, 5}, mixed);
  return paint(name, kPicture, [&](const glm::vec2& uv) {
    const glm::vec3 ground =
        glm::mix(glm::vec3(0.8f, 0.74f, 0.6f), glm::vec3(0.65f, 0.6f, 0.5f), paper(uv));
    return abstract(uv, ground, mixed);
  });
}

}  // namespace eigenlight
