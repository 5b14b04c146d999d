#include "render/lights/environment_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace eigenlight {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

EnvironmentLight::EnvironmentLight(const std::optional<Environment>& environment) {
  if (!environment) return;
  extent_ = environment->extent;
  texels_ = environment->radiance;
  std::vector<float> row_weights;
  std::vector<float> weights(static_cast<std::size_t>(extent_.width));
  for (int y = 0; y < extent_.height; ++y) {
    const float sine =
        std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(extent_.height));
    for (int x = 0; x < extent_.width; ++x) {
      weights[static_cast<std::size_t>(x)] = luminance(texel(x, y)) * sine;
    }
    columns_.emplace_back(weights);
    row_weights.push_back(static_cast<float>(columns_.back().total()));
  }
  rows_ = Distribution(row_weights);
  const float texel_area = 2.0f * kPi * kPi / static_cast<float>(extent_.pixels());
  power_ = static_cast<float>(rows_.total()) * texel_area;
}

const glm::vec3& EnvironmentLight::texel(int x, int y) const {
  return texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(extent_.width) +
                 static_cast<std::size_t>(x)];
}

glm::vec2 EnvironmentLight::to_pixel(const glm::vec3& direction) const {
  const float u = 0.5f + std::atan2(direction.z, direction.x) / (2.0f * kPi);
  const float v = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / kPi;
  return {u * static_cast<float>(extent_.width), v * static_cast<float>(extent_.height)};
}

glm::vec3 EnvironmentLight::radiance(const glm::vec3& direction) const {
  if (texels_.empty()) return glm::vec3(0.0f);
  const glm::vec2 p = to_pixel(direction) - 0.5f;
  const glm::vec2 base = glm::floor(p);
  const glm::vec2 f = p - base;
  const auto column = [&](int x) { return (x + extent_.width) % extent_.width; };
  const auto row = [&](int y) { return std::clamp(y, 0, extent_.height - 1); };
  const int x0 = column(static_cast<int>(base.x)), x1 = column(static_cast<int>(base.x) + 1);
  const int y0 = row(static_cast<int>(base.y)), y1 = row(static_cast<int>(base.y) + 1);
  return glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), f.x),
                  glm::mix(texel(x0, y1), texel(x1, y1), f.x), f.y);
}

// Density per steradian from the probability of a texel. At row coordinate y a texel has a solid
// angle of 2 pi^2 sin(theta) / pixels.
float EnvironmentLight::texel_pdf(float probability, float y) const {
  const float sine = std::sin(kPi * y / static_cast<float>(extent_.height));
  if (!(sine > 0.0f)) return 0.0f;
  return probability * static_cast<float>(extent_.pixels()) / (2.0f * kPi * kPi * sine);
}

EnvironmentLight::Sample EnvironmentLight::sample(const glm::vec2& u) const {
  const Distribution::Choice row = rows_.sample(u.y);
  const Distribution::Choice column = columns_[row.index].sample(u.x);
  const float x = static_cast<float>(column.index) + column.remainder;
  const float y = static_cast<float>(row.index) + row.remainder;
  const float phi = (x / static_cast<float>(extent_.width) - 0.5f) * 2.0f * kPi;
  const float theta = y / static_cast<float>(extent_.height) * kPi;
  const float sine = std::sin(theta);
  return {{sine * std::cos(phi), std::cos(theta), sine * std::sin(phi)},
          texel_pdf(row.probability * column.probability, y)};
}

float EnvironmentLight::pdf(const glm::vec3& direction) const {
  const glm::vec2 p = to_pixel(direction);
  const auto y = static_cast<std::size_t>(std::clamp(static_cast<int>(p.y), 0, extent_.height - 1));
  const auto x = static_cast<std::size_t>(std::clamp(static_cast<int>(p.x), 0, extent_.width - 1));
  if (!(columns_[y].total() > 0.0)) return 0.0f;
  return texel_pdf(rows_.probability(y) * columns_[y].probability(x), p.y);
}

}  // namespace eigenlight
