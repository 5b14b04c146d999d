#include "spatial/training/training_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "frame/random.h"

namespace eigenlight {
namespace {

constexpr std::uint32_t kShapes = 24;

/// Numbers of one picture or shape, drawn one after the other.
class Dice {
 public:
  explicit Dice(std::uint32_t key) : key_(key) {}
  [[nodiscard]] float roll() { return to_unit(hash_key(key_, next_++)); }
  [[nodiscard]] float between(float low, float high) { return low + (high - low) * roll(); }
  [[nodiscard]] glm::vec3 color() { return {roll(), roll(), roll()}; }

 private:
  std::uint32_t key_, next_ = 0;
};

float lattice(std::uint32_t key, int x, int y) {
  return to_unit(hash_key(key, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)));
}

// Value noise in [0, 1): random values on whole coordinates, joined smoothly.
float noise(std::uint32_t key, glm::vec2 at) {
  const glm::vec2 cell = glm::floor(at), t = at - cell, s = t * t * (3.0f - 2.0f * t);
  const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
  return glm::mix(glm::mix(lattice(key, x, y), lattice(key, x + 1, y), s.x),
                  glm::mix(lattice(key, x, y + 1), lattice(key, x + 1, y + 1), s.x), s.y);
}

float clouds(std::uint32_t key, glm::vec2 at) {
  float sum = 0.0f, share = 0.5f;
  for (std::uint32_t octave = 0; octave < 5; ++octave, share *= 0.5f, at *= 2.0f) {
    sum += share * noise(hash_key(key, octave), at);
  }
  return sum;
}

enum class Kind { kDisc, kBar, kCheckers };

struct Shape {
  Shape(Dice dice, Extent extent, std::uint32_t k) : key(k) {
    const auto side = static_cast<float>(std::min(extent.width, extent.height));
    kind = static_cast<Kind>(static_cast<int>(3.0f * dice.roll()));
    center = {dice.between(0.0f, static_cast<float>(extent.width)),
              dice.between(0.0f, static_cast<float>(extent.height))};
    const float angle = dice.between(0.0f, 6.2832f);
    axis = {std::cos(angle), std::sin(angle)};
    // From the size of a few pixels to that of the picture.
    size = side * std::exp2(dice.between(-5.5f, -1.0f));
    low = dice.color();
    high = glm::mix(low, dice.color(), dice.roll());
    grain = dice.roll() < 0.5f ? dice.between(0.0f, 0.3f) : 0.0f;
    cell = std::exp2(dice.between(1.5f, 4.0f));
  }

  [[nodiscard]] bool covers(glm::vec2 at) const {
    const glm::vec2 d = local(at);
    if (kind == Kind::kDisc) return glm::dot(d, d) < size * size;
    return std::abs(d.x) < size * (kind == Kind::kBar ? 3.0f : 1.5f) && std::abs(d.y) < size;
  }
  [[nodiscard]] glm::vec3 color(glm::vec2 at) const {
    const glm::vec2 d = local(at);
    float t = 0.5f + 0.5f * d.x / (3.0f * size);
    if (kind == Kind::kCheckers) {
      const glm::vec2 tile = glm::floor(d / cell);
      t = std::abs(std::fmod(tile.x + tile.y, 2.0f));
    }
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    return glm::mix(low, high, t) + grain * (lattice(key, x, y) - 0.5f);
  }

  Kind kind;
  std::uint32_t key;
  glm::vec2 center{}, axis{};
  float size = 0.0f, grain = 0.0f, cell = 0.0f;
  glm::vec3 low{}, high{};

 private:
  [[nodiscard]] glm::vec2 local(glm::vec2 at) const {
    const glm::vec2 d = at - center;
    return {glm::dot(d, axis), d.y * axis.x - d.x * axis.y};
  }
};

}  // namespace

Planes<3> paint_training_image(Extent extent, std::uint32_t seed) {
  Dice dice(hash_key(seed, 1u));
  const glm::vec3 dark = dice.color(), light = dice.color();
  const float scale = std::exp2(dice.between(-6.0f, -3.0f));
  std::vector<Shape> shapes;
  for (std::uint32_t i = 0; i < kShapes; ++i) {
    shapes.emplace_back(Dice(hash_key(seed, 2u, i)), extent, hash_key(seed, 3u, i));
  }
  Planes<3> image = make_planes<3>(extent);
  for (int y = 0; y < extent.height; ++y) {
    for (int x = 0; x < extent.width; ++x) {
      const glm::vec2 at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      glm::vec3 color = glm::mix(dark, light, clouds(seed, at * scale));
      for (const Shape& shape : shapes) {
        if (shape.covers(at)) color = shape.color(at);
      }
      for (int c = 0; c < 3; ++c) {
        image[static_cast<std::size_t>(c)](x, y) = std::clamp(color[c], 0.0f, 1.0f);
      }
    }
  }
  return image;
}

}  // namespace eigenlight
